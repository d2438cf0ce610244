#pragma once

namespace glowworm {

/// Lets the system take back the pages of the program's own files, code and tables: most of them,
/// some 25 MB, only the dynamic linker has read (symbols of libraries), and the others come again
/// when they are next touched.
void forget_loader_pages();

}  // namespace glowworm
