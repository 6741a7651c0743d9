//! From a model and a state to pixels.
//!
//! | file | does |
//! |---|---|
//! | [`frame`] | a state as triangles and lines, on the processor |
//! | [`renderer`] | triangles and lines as pixels of a texture, on the graphics device |
//! | [`device`] | opens a graphics device without a window, reads pixels back |
//! | [`studio`] | all of these together, for pictures without a window |
//! | [`backdrop`] | the picture and the colour of panels under what egui draws in a window |
//! | [`ink`] | texts and panels of a window on devices that are the processor itself |
//! | [`overlay`] | legend, scale bar, axes and texts over the picture |

pub mod backdrop;
pub mod device;
pub mod frame;
pub mod ink;
pub mod overlay;
pub mod renderer;
pub mod studio;
