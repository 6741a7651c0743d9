//! Pictures in a row as an animated GIF, which every browser and mail program shows.

use crate::draw::device::Pixels;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Shortest time between pictures in s: many programs show nothing quicker.
const SHORTEST: f64 = 0.04;

/// An animation that is being written.
pub struct Animation {
    path: PathBuf,
    encoder: Option<(gif::Encoder<BufWriter<File>>, [u32; 2])>,
    /// The picture that is shown until the next one comes, and its time.
    waiting: Option<(Pixels, f64)>,
    frames: usize,
}

impl Animation {
    /// Makes the folder; the file is made with the first picture.
    ///
    /// # Errors
    /// When the folder cannot be made, in words.
    pub fn start(path: &Path) -> Result<Animation, String> {
        if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|e| format!("cannot make the folder {}: {e}", folder.display()))?;
        }
        Ok(Animation { path: path.to_owned(), encoder: None, waiting: None, frames: 0 })
    }

    /// Pictures so far.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Adds a picture of a simulated time; those that follow too closely, or show an earlier time, are left out.
    ///
    /// # Errors
    /// When the file cannot be written, or the picture has another size than the first, in words.
    pub fn add(&mut self, pixels: &Pixels, time: f64) -> Result<(), String> {
        if let Some((before, then)) = &self.waiting {
            if time - then < SHORTEST {
                return Ok(());
            }
            let hundredths = ((time - then) * 100.0).round().min(500.0) as u16;
            let before = before.clone();
            self.write(&before, hundredths)?;
        }
        self.frames += 1;
        self.waiting = Some((pixels.clone(), time));
        Ok(())
    }

    fn write(&mut self, pixels: &Pixels, hundredths: u16) -> Result<(), String> {
        let complain = |e: &dyn std::fmt::Display| format!("cannot write {}: {e}", self.path.display());
        let size = pixels.size.map(|s| u16::try_from(s).unwrap_or(u16::MAX));
        if size.iter().zip(pixels.size).any(|(&short, long)| u32::from(short) != long) {
            return Err(complain(&"pictures are wider or higher than 65535 pixels"));
        }
        if self.encoder.is_none() {
            let file = BufWriter::new(File::create(&self.path).map_err(|e| complain(&e))?);
            let mut encoder = gif::Encoder::new(file, size[0], size[1], &[]).map_err(|e| complain(&e))?;
            encoder.set_repeat(gif::Repeat::Infinite).map_err(|e| complain(&e))?;
            self.encoder = Some((encoder, pixels.size));
        }
        let Some((encoder, first)) = &mut self.encoder else { return Ok(()) };
        if *first != pixels.size {
            return Err(format!("{}: the window changed its size; the animation ends here", self.path.display()));
        }
        let mut bytes = pixels.bytes.clone();
        // 1 is best and slow, 30 worst and quick.
        let mut frame = gif::Frame::from_rgba_speed(size[0], size[1], &mut bytes, 15);
        frame.delay = hundredths;
        encoder.write_frame(&frame).map_err(|e| format!("cannot write {}: {e}", self.path.display()))
    }

    /// Writes the last picture and closes the file.
    ///
    /// # Errors
    /// When the file cannot be written, or there was no picture, in words.
    pub fn finish(mut self) -> Result<PathBuf, String> {
        match self.waiting.take() {
            Some((last, _)) => self.write(&last, 10)?,
            None => return Err("there was no picture to write".into()),
        }
        Ok(self.path)
    }
}
