-- Who works on a simulation that is not done yet; removed when it is recorded.
CREATE TABLE claims (
  hash TEXT PRIMARY KEY,               -- of the simulation
  owner TEXT NOT NULL,                 -- the run: machine, process, when that began
  beat REAL NOT NULL                   -- when the run was last seen alive, by the database's clock
);
-- Pictures of the states in which simulations ended.
CREATE TABLE pictures (
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  path TEXT NOT NULL,                  -- relative to the folder in which the results lie
  PRIMARY KEY (simulation_id, path)
);
