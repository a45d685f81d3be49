//! Places in a program.

use std::path::Path;

use object::{Object, ObjectSymbol};

/// The address of a symbol, by its name without the path before it: `Player::execute`, which one version of the compiler calls
/// `firmware::app::player::Player::execute` and the next `<firmware::app::player::Player>::execute`.
pub fn address(elf: &Path, name: &str) -> u32 {
    let bytes = std::fs::read(elf).unwrap_or_else(|error| panic!("{}: {error}", elf.display()));
    let file = object::File::parse(&*bytes).unwrap_or_else(|error| panic!("{}: {error}", elf.display()));
    let is_it = |mangled: &str| {
        let whole = format!("{:#}", rustc_demangle::demangle(mangled)).replace(['<', '>'], "");
        whole == name || whole.ends_with(&format!("::{name}"))
    };
    let symbol = file.symbols().find(|symbol| symbol.name().is_ok_and(is_it));
    symbol.map_or_else(|| panic!("no {name} in {}", elf.display()), |symbol| symbol.address() as u32 & !1)
}
