#pragma once

#include <initializer_list>
#include <stop_token>

#include "octree/octree_file.h"
#include "octree/rules.h"

namespace glowworm {

/// The sections of a file whose bytes do not match their checksums, a sentence each; in parallel,
/// some GB a second. Empty `kinds`: all of them, and the zeros between them. Asked to stop, it ends
/// soon and says nothing.
Sentences check_checksums(const OctreeFile& file, std::initializer_list<SectionKind> kinds = {},
                          const std::stop_token& stop = {});

}  // namespace glowworm
