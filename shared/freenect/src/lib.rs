//! libfreenect, loaded at run time: raw bindings and the safe wrapper.
