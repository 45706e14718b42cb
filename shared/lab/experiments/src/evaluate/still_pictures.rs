//! `tabula-lab evaluate still-pictures`: one picture played again and again, the same bytes or with
//! depth noise drawn anew, must keep its table, its tracks and its labels.

mod picture;
mod play;
mod report;

use crate::arguments::StillPicturesArguments;
use crate::output_files::{create_folder, write};
use crate::parallel;
use command_line::Output;
use picture::StillPictures;
use play::play;
use report::{PictureResult, StillPicturesReport, page};
use service::Failure;
use std::process::ExitCode;

/// Folder of the pictures, inside the output folder.
const PICTURES: &str = "pictures";

/// Plays all pictures, and writes the report.
pub(super) fn run(
    arguments: &StillPicturesArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out.join(PICTURES))?;
    let pictures = StillPictures::open(&arguments.dataset, arguments.every as usize)?;
    let n_frames = arguments.frames as usize;
    let plays = parallel::try_map(pictures.len(), "pictures", output, |number| {
        let picture = pictures.read(number)?;
        let (equal, drawn) = play(&picture, n_frames, None)?;
        let file = format!("{PICTURES}/{}.png", picture.name.replace('/', "-"));
        write(&arguments.out.join(&file), &drawn)?;
        let seed = arguments.seed.wrapping_add(number as u64);
        let (noise, _) = play(&picture, n_frames, Some(seed))?;
        Ok(PictureResult {
            name: picture.name,
            picture: file,
            equal,
            noise,
        })
    })?;
    let document = StillPicturesReport::of(plays, arguments);
    page(&document).publish(&arguments.out, "still-pictures.json", &document, output)
}

#[cfg(test)]
mod tests;
