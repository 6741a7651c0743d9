CREATE TABLE machines (
  id INTEGER PRIMARY KEY,
  host TEXT NOT NULL, processor TEXT NOT NULL, cores INTEGER NOT NULL, system TEXT NOT NULL,
  UNIQUE (host, processor, cores, system)
);
CREATE TABLE groups (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  definition TEXT NOT NULL,            -- SHA-256 of everything that describes the group
  folder TEXT NOT NULL, source TEXT NOT NULL, scene TEXT NOT NULL,
  samples INTEGER NOT NULL,
  UNIQUE (name, definition)
);
CREATE TABLE parameters (
  id INTEGER PRIMARY KEY,
  group_id INTEGER NOT NULL REFERENCES groups (id),
  position INTEGER NOT NULL,           -- 0 varies most quickly
  name TEXT NOT NULL,
  variation TEXT NOT NULL,             -- list, adding, multiplying, latin hypercube
  first REAL, last REAL, step REAL,    -- of a list: none
  count INTEGER NOT NULL,
  UNIQUE (group_id, position)
);
CREATE TABLE bars (
  id INTEGER PRIMARY KEY,
  group_id INTEGER NOT NULL REFERENCES groups (id),
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  UNIQUE (group_id, position)
);
CREATE TABLE sections (
  bar_id INTEGER NOT NULL REFERENCES bars (id),
  position INTEGER NOT NULL,
  until REAL NOT NULL, law TEXT NOT NULL, element TEXT NOT NULL, quadrature TEXT,
  PRIMARY KEY (bar_id, position)
);
-- A place in a group; several places may share one simulation.
CREATE TABLE members (
  group_id INTEGER NOT NULL REFERENCES groups (id),
  number INTEGER NOT NULL,
  hash TEXT NOT NULL,                  -- of the simulation, which exists when it is done
  bar_id INTEGER REFERENCES bars (id),
  device TEXT NOT NULL,
  PRIMARY KEY (group_id, number)
);
CREATE INDEX members_by_hash ON members (hash);
CREATE TABLE member_values (
  group_id INTEGER NOT NULL, number INTEGER NOT NULL,
  parameter_id INTEGER NOT NULL REFERENCES parameters (id),
  value TEXT NOT NULL,                 -- as TOML: numbers read back to the same bits
  PRIMARY KEY (group_id, number, parameter_id),
  FOREIGN KEY (group_id, number) REFERENCES members (group_id, number)
);
CREATE TABLE simulations (
  id INTEGER PRIMARY KEY,
  hash TEXT NOT NULL UNIQUE,           -- of everything that determines the result
  status TEXT NOT NULL,                -- finished, at rest, failed, invalid, crashed
  reason TEXT NOT NULL,                -- why it is failed, invalid or crashed; else empty
  program TEXT NOT NULL, device TEXT NOT NULL, threads INTEGER NOT NULL,
  machine_id INTEGER NOT NULL REFERENCES machines (id),
  wall_s REAL NOT NULL,                -- of the process
  steps INTEGER, simulated_s REAL, nodes INTEGER
);
CREATE TABLE materials (
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  body TEXT NOT NULL, position INTEGER NOT NULL,
  law TEXT NOT NULL, parameters TEXT NOT NULL,  -- JSON
  PRIMARY KEY (simulation_id, body, position)
);
CREATE TABLE element_counts (
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  element TEXT NOT NULL, count INTEGER NOT NULL,
  PRIMARY KEY (simulation_id, element)
);
CREATE TABLE timings (
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  phase TEXT NOT NULL, ms_per_step REAL NOT NULL,
  PRIMARY KEY (simulation_id, phase)
);
CREATE TABLE measurements (
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  probe TEXT NOT NULL, quantity TEXT NOT NULL, component TEXT NOT NULL, value REAL NOT NULL,
  PRIMARY KEY (simulation_id, probe, quantity, component)
);
CREATE TABLE curves (
  id INTEGER PRIMARY KEY,
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  probe TEXT NOT NULL, quantity TEXT NOT NULL,
  UNIQUE (simulation_id, probe, quantity)
);
CREATE TABLE points (
  curve_id INTEGER NOT NULL REFERENCES curves (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  PRIMARY KEY (curve_id, position)
);
CREATE TABLE meshes (
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  body TEXT NOT NULL,
  path TEXT NOT NULL,                  -- relative to the database's folder
  hash TEXT NOT NULL,                  -- SHA-256 of the file
  PRIMARY KEY (simulation_id, body)
);
-- What the scene's [[expect]] compared.
CREATE TABLE errors (
  simulation_id INTEGER NOT NULL REFERENCES simulations (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  name TEXT NOT NULL, difference REAL, tolerance REAL NOT NULL, met INTEGER NOT NULL,
  PRIMARY KEY (simulation_id, position)
);
