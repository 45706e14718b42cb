//! Table of categories: name, density, friction and generator.

use crate::Variation;
use crate::families::{
    containers, cookware, crockery, cutlery, devices, food, fruit, hardware, leisure, packaging,
    packets, stationery, tools, toys, vegetables,
};
use mesh::Solid;

/// Category of generated objects.
#[derive(Debug, Clone, Copy)]
pub struct Category {
    /// Unique name of lower case letters, digits and hyphens.
    pub name: &'static str,
    /// Mean density over the volume of the modelled parts, contents included, kg/m³. Chosen.
    pub(crate) density_kg_m3: f32,
    /// Coulomb friction coefficient against a wooden table. Chosen.
    pub(crate) friction: f32,
    /// Generator of an instance, in metres, z up.
    pub(crate) build: fn(&mut Variation) -> Solid,
}

/// All categories, in a fixed order.
pub fn categories() -> &'static [Category] {
    CATEGORIES
}

/// Category by its name; `None` for an unknown name.
pub fn category(name: &str) -> Option<&'static Category> {
    CATEGORIES.iter().find(|category| category.name == name)
}

const fn row(
    name: &'static str,
    density_kg_m3: f32,
    friction: f32,
    build: fn(&mut Variation) -> Solid,
) -> Category {
    Category {
        name,
        density_kg_m3,
        friction,
        build,
    }
}

/// Categories in their fixed order.
const CATEGORIES: &[Category] = &[
    row("bowl", 2300.0, 0.4, crockery::bowl),
    row("mug", 2300.0, 0.4, crockery::mug),
    row("teacup", 2300.0, 0.4, crockery::teacup),
    row("plate", 2300.0, 0.4, crockery::plate),
    row("goblet", 4000.0, 0.35, crockery::goblet),
    row("teapot", 900.0, 0.4, crockery::teapot),
    row("pitcher", 2300.0, 0.4, crockery::pitcher),
    row("vase", 2300.0, 0.4, crockery::vase),
    row("flowerpot", 1700.0, 0.55, crockery::flowerpot),
    row("pot", 3000.0, 0.35, cookware::pot),
    row("pan", 4500.0, 0.35, cookware::pan),
    row("kettle", 500.0, 0.35, cookware::kettle),
    row("tray", 700.0, 0.4, cookware::tray),
    row("rolling-pin", 700.0, 0.4, cookware::rolling_pin),
    row("bottle", 1100.0, 0.4, containers::bottle),
    row("soda-can", 950.0, 0.35, containers::soda_can),
    row("tin-can", 1100.0, 0.35, containers::tin_can),
    row("jar", 1200.0, 0.4, containers::jar),
    row("shampoo", 950.0, 0.35, containers::shampoo),
    row("spray-bottle", 850.0, 0.35, containers::spray_bottle),
    row("salt-shaker", 1300.0, 0.4, containers::salt_shaker),
    row("thermos", 700.0, 0.4, containers::thermos),
    row("cereal-box", 130.0, 0.4, packets::cereal_box),
    row("tissue-box", 150.0, 0.4, packets::tissue_box),
    row("matchbox", 350.0, 0.45, packets::matchbox),
    row("milk-carton", 1000.0, 0.4, packets::milk_carton),
    row("juice-box", 1000.0, 0.4, packets::juice_box),
    row("book", 700.0, 0.4, packets::book),
    row("sponge", 80.0, 0.7, packets::sponge),
    row("toothpaste", 1100.0, 0.4, packets::toothpaste),
    row("spoon", 5500.0, 0.3, cutlery::spoon),
    row("fork", 5500.0, 0.3, cutlery::fork),
    row("knife", 3500.0, 0.3, cutlery::knife),
    row("spatula", 1400.0, 0.4, cutlery::spatula),
    row("ladle", 2500.0, 0.35, cutlery::ladle),
    row("whisk", 1600.0, 0.35, cutlery::whisk),
    row("apple", 850.0, 0.45, fruit::apple),
    row("pear", 950.0, 0.45, fruit::pear),
    row("banana", 950.0, 0.5, fruit::banana),
    row("orange", 900.0, 0.5, fruit::orange),
    row("lemon", 950.0, 0.5, fruit::lemon),
    row("strawberry", 900.0, 0.5, fruit::strawberry),
    row("peach", 950.0, 0.55, fruit::peach),
    row("tomato", 980.0, 0.45, vegetables::tomato),
    row("carrot", 1030.0, 0.5, vegetables::carrot),
    row("bell-pepper", 500.0, 0.45, vegetables::bell_pepper),
    row("eggplant", 700.0, 0.4, vegetables::eggplant),
    row("mushroom", 600.0, 0.55, vegetables::mushroom),
    row("donut", 450.0, 0.5, food::donut),
    row("bread", 300.0, 0.55, food::bread),
    row("egg", 1050.0, 0.4, food::egg),
    row("cupcake", 500.0, 0.5, food::cupcake),
    row("croissant", 250.0, 0.5, food::croissant),
    row("hammer", 3500.0, 0.4, tools::hammer),
    row("screwdriver", 1500.0, 0.4, tools::screwdriver),
    row("wrench", 7800.0, 0.35, tools::wrench),
    row("pliers", 4500.0, 0.4, tools::pliers),
    row("clamp", 6500.0, 0.4, tools::clamp),
    row("flashlight", 1600.0, 0.4, hardware::flashlight),
    row("paintbrush", 800.0, 0.4, hardware::paintbrush),
    row("light-bulb", 350.0, 0.4, hardware::light_bulb),
    row("magnifier", 1500.0, 0.4, hardware::magnifier),
    row("scissors", 3000.0, 0.35, stationery::scissors),
    row("tape-roll", 900.0, 0.45, stationery::tape_roll),
    row("marker", 800.0, 0.35, stationery::marker),
    row("stapler", 1500.0, 0.45, stationery::stapler),
    row("glue-stick", 900.0, 0.4, stationery::glue_stick),
    row("calculator", 900.0, 0.45, stationery::calculator),
    row("pencil-cup", 1100.0, 0.4, stationery::pencil_cup),
    row("phone", 1900.0, 0.4, devices::phone),
    row("remote-control", 900.0, 0.4, devices::remote_control),
    row("computer-mouse", 1000.0, 0.35, devices::computer_mouse),
    row("keyboard", 900.0, 0.5, devices::keyboard),
    row("lamp", 900.0, 0.45, devices::lamp),
    row("headphones", 1200.0, 0.5, devices::headphones),
    row("tennis-ball", 400.0, 0.6, leisure::tennis_ball),
    row("soccer-ball", 100.0, 0.6, leisure::soccer_ball),
    row("puzzle-cube", 600.0, 0.4, toys::puzzle_cube),
    row("toy-car", 1000.0, 0.4, toys::toy_car),
    row("toy-duck", 300.0, 0.45, toys::toy_duck),
    row("toy-brick", 500.0, 0.4, toys::toy_brick),
    row("toy-bridge", 650.0, 0.45, toys::toy_bridge),
    row("candle", 900.0, 0.45, leisure::candle),
    row("cap", 400.0, 0.6, leisure::cap),
    row("dice", 1100.0, 0.4, toys::dice),
    row("teddy", 150.0, 0.6, toys::teddy),
    row("carton", 250.0, 0.45, packaging::carton),
    row("magazine", 900.0, 0.45, packaging::magazine),
    row("cookie-tin", 350.0, 0.4, packaging::cookie_tin),
    row("open-box", 700.0, 0.45, packaging::open_box),
];
