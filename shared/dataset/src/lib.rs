//! File formats: PCD, PLY, RGB-D sequences and fakenect folders.
