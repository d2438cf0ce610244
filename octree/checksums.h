#pragma once

#include <initializer_list>

#include "octree/octree_file.h"
#include "octree/rules.h"

namespace glowworm {

/// The sections of a file whose bytes do not match their checksums, a sentence each; in parallel,
/// some GB a second. Empty `kinds`: all of them, and the zeros between them.
Sentences check_checksums(const OctreeFile& file, std::initializer_list<SectionKind> kinds = {});

}  // namespace glowworm
