//! Ports over iceoryx2 shared memory and the control protocol's carriers.
