//! Gives every image the linker script of its board.

fn main() {
    let scripts = format!("{}/link", std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default());
    println!("cargo::rerun-if-changed={scripts}");
    for (image, board) in
        [("carriage-am335x", "am335x"), ("carriage-realview", "realview"), ("timing", "realview"), ("cost", "realview")]
    {
        println!("cargo::rustc-link-arg-bin={image}=-L{scripts}");
        println!("cargo::rustc-link-arg-bin={image}=-T{scripts}/{board}.ld");
    }
}
