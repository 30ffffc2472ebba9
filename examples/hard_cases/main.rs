//! Hard numerical cases: what the usual formula gives in f32, what pts gives, what it is.
//!
//! `cargo run --release --example hard_cases` prints a line a case and, run in the repository, writes the tables of
//! docs/numerics.md and its pictures. It fails if a case does.

mod case;
mod geometry;
mod light;
mod naive;
mod page;
mod pictures;
mod price;
mod shading;
mod tracer;

use case::Case;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cases: Vec<Case> = [geometry::cases(), light::cases(), shading::cases()]
        .into_iter()
        .flatten()
        .collect();
    for case in &cases {
        let [item, what, naive, pts, exact, tolerance, verdict] = case.columns();
        println!("{verdict:8} {item:>6}  {what}: usual {naive}, pts {pts}, exact {exact} ± {tolerance}");
    }
    let prices = price::measure();
    for price in &prices {
        println!("{price}");
    }
    let page = Path::new("docs/numerics.md");
    if page.exists() {
        page::replace(page, "cases", &page::cases(&cases))?;
        page::replace(page, "price", &page::prices(&prices))?;
        let seen = pictures::sheet(Path::new("docs/numerics/seen.png"))?;
        page::replace(page, "seen", &page::seen(&seen))?;
        println!("wrote {} and docs/numerics/seen.png", page.display());
    }
    let failed = cases.iter().filter(|c| !c.holds(c.pts)).count();
    if failed > 0 {
        return Err(format!("{failed} cases fail").into());
    }
    Ok(())
}
