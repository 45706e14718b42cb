//! Header of a PLY file.

use crate::Encoding;
use crate::error::Error;
use file_access::{NumberType, excerpt};

/// Limit of the search for the end of the header, bytes.
const MAX_HEADER_BYTES: usize = 1 << 16;

/// Parsed header of a PLY file.
#[derive(Debug)]
pub(super) struct Header<'a> {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element<'a>>,
    /// Offset of the first element's data in the PLY file, bytes.
    pub(super) data_offset: usize,
}

/// Element: a table of the file.
#[derive(Debug)]
pub(super) struct Element<'a> {
    pub(super) name: &'a str,
    pub(super) n_rows: usize,
    pub(super) properties: Vec<Property<'a>>,
}

/// Property: a column of a PLY element.
#[derive(Debug)]
pub(super) struct Property<'a> {
    pub(super) name: &'a str,
    pub(super) kind: PropertyKind,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum PropertyKind {
    Number(NumberType),
    List { count: NumberType, item: NumberType },
}

impl<'a> Header<'a> {
    pub(super) fn parse(bytes: &'a [u8]) -> Result<Self, Error> {
        let mut lines = Lines {
            rest: bytes,
            n_bytes: 0,
            number: 0,
        };
        if lines.next()? != "ply" {
            return Err(Error::NoHeader);
        }
        let (mut encoding, mut elements) = (None, Vec::new());
        loop {
            let line = lines.next()?;
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let parsed = match words[..] {
                ["end_header"] => break,
                ["comment" | "obj_info", ..] => Ok(()),
                ["format", name, "1.0"] if encoding.is_none() => {
                    parse_encoding(name).map(|found| encoding = Some(found))
                }
                ["element", name, n_rows] => push_element(&mut elements, name, n_rows),
                ["property", ..] => push_property(&mut elements, &words[1..]),
                _ => Err(format!(
                    "\"{}\" is no line of a PLY header of version 1.0",
                    excerpt(line)
                )),
            };
            parsed.map_err(|problem| Error::HeaderLine {
                line: lines.number,
                problem,
            })?;
        }
        let encoding = encoding.ok_or(Error::Elements("the line \"format …\" is missing"))?;
        Ok(Self {
            encoding,
            elements,
            data_offset: lines.n_bytes,
        })
    }
}

struct Lines<'a> {
    rest: &'a [u8],
    n_bytes: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Result<&'a str, Error> {
        let window = &self.rest[..self.rest.len().min(MAX_HEADER_BYTES - self.n_bytes)];
        let end = window
            .iter()
            .position(|&byte| byte == b'\n')
            .ok_or(Error::NoHeader)?;
        let line = std::str::from_utf8(&window[..end]).map_err(|_| Error::NoHeader)?;
        self.rest = &self.rest[end + 1..];
        self.n_bytes += end + 1;
        self.number += 1;
        Ok(line.trim_ascii_end())
    }
}

fn parse_encoding(name: &str) -> Result<Encoding, String> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::BinaryLittleEndian),
        "binary_big_endian" => Ok(Encoding::BinaryBigEndian),
        _ => Err("the format must be ascii, binary_little_endian or binary_big_endian".to_owned()),
    }
}

fn push_element<'a>(
    elements: &mut Vec<Element<'a>>,
    name: &'a str,
    n_rows: &str,
) -> Result<(), String> {
    if elements.iter().any(|element| element.name == name) {
        return Err(format!("the element \"{}\" is there twice", excerpt(name)));
    }
    let n_rows = n_rows
        .parse()
        .map_err(|_| format!("\"{}\" is not a count", excerpt(n_rows)))?;
    elements.push(Element {
        name,
        n_rows,
        properties: Vec::new(),
    });
    Ok(())
}

fn push_property<'a>(elements: &mut [Element<'a>], words: &[&'a str]) -> Result<(), String> {
    let element = elements
        .last_mut()
        .ok_or("a property comes before the first element")?;
    let (name, kind) = match *words {
        ["list", count, item, name] => (
            name,
            PropertyKind::List {
                count: list_count(count)?,
                item: number_type(item)?,
            },
        ),
        [number, name] => (name, PropertyKind::Number(number_type(number)?)),
        _ => return Err("a property is a type and a name, or a list".to_owned()),
    };
    if element
        .properties
        .iter()
        .any(|property| property.name == name)
    {
        return Err(format!("the property \"{}\" is there twice", excerpt(name)));
    }
    element.properties.push(Property { name, kind });
    Ok(())
}

fn list_count(name: &str) -> Result<NumberType, String> {
    let number = number_type(name)?;
    number
        .is_integer()
        .then_some(number)
        .ok_or("a list is counted by an integer".to_owned())
}

fn number_type(name: &str) -> Result<NumberType, String> {
    Ok(match name {
        "char" | "int8" => NumberType::I8,
        "uchar" | "uint8" => NumberType::U8,
        "short" | "int16" => NumberType::I16,
        "ushort" | "uint16" => NumberType::U16,
        "int" | "int32" => NumberType::I32,
        "uint" | "uint32" => NumberType::U32,
        "float" | "float32" => NumberType::F32,
        "double" | "float64" => NumberType::F64,
        _ => return Err(format!("\"{}\" is no type of number", excerpt(name))),
    })
}
