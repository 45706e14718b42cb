//! Elements of a COLLADA document by name and by identifier.

use crate::ModelError;
use file_access::excerpt;
use roxmltree::Node;
use std::collections::HashMap;
use std::str::FromStr;

/// COLLADA document with its elements by identifier.
pub(super) struct Document<'a> {
    pub(super) root: Node<'a, 'a>,
    by_id: HashMap<&'a str, Node<'a, 'a>>,
}

impl<'a> Document<'a> {
    /// Index of a document; of elements with the same identifier the first one counts.
    pub(super) fn new(root: Node<'a, 'a>) -> Self {
        let mut by_id = HashMap::new();
        for node in root.descendants().filter(Node::is_element) {
            if let Some(id) = node.attribute("id") {
                by_id.entry(id).or_insert(node);
            }
        }
        Self { root, by_id }
    }

    /// Element of this name and identifier.
    pub(super) fn element(&self, name: &str, id: &str) -> Option<Node<'a, 'a>> {
        let found = self.by_id.get(id).copied()?;
        (found.tag_name().name() == name).then_some(found)
    }

    /// Element to which an attribute of a node refers, as `#identifier`.
    pub(super) fn target(
        &self,
        node: Node<'a, 'a>,
        attribute: &str,
        name: &str,
    ) -> Option<Node<'a, 'a>> {
        let url = node.attribute(attribute)?;
        self.element(name, url.strip_prefix('#')?)
    }
}

/// Child elements of this name.
pub(super) fn children<'a>(
    node: Node<'a, 'a>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children()
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// First child element of this name.
pub(super) fn child<'a>(node: Node<'a, 'a>, name: &'static str) -> Option<Node<'a, 'a>> {
    children(node, name).next()
}

/// Parses the text of an element as numbers, separated by spaces.
pub(super) fn numbers<T: FromStr>(node: Node<'_, '_>) -> Result<Vec<T>, ModelError> {
    let words = node.text().unwrap_or_default().split_ascii_whitespace();
    words
        .map(|word| {
            let number = word.parse();
            number.map_err(|_| wrong(node, format!("\"{}\" is not such a number", excerpt(word))))
        })
        .collect()
}

/// Error about an element.
pub(super) fn wrong(node: Node<'_, '_>, problem: String) -> ModelError {
    ModelError::Element {
        element: excerpt(node.tag_name().name()),
        line: node.document().text_pos_at(node.range().start).row,
        problem,
    }
}
