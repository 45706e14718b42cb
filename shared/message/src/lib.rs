//! What crosses a process border: data-plane and control-plane types.
