//! Prints the mean of each channel of EXR images: `cargo run --release --example image_mean -- picture.exr …`.

use exr::prelude::*;

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    for path in std::env::args().skip(1) {
        let image = read_first_flat_layer_from_file(&path)?;
        print!("{path}");
        for channel in &image.layer_data.channel_data.list {
            let values = channel.sample_data.values_as_f32();
            let (sum, n) = values.fold((0.0, 0u64), |(sum, n), v| (sum + f64::from(v), n + 1));
            print!(" {}={:.5}", channel.name, sum / n as f64);
        }
        println!();
    }
    Ok(())
}
