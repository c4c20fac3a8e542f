//! Arguments to engine to files
