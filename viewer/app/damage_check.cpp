#include "viewer/app/damage_check.h"

namespace glowworm {

DamageCheck::DamageCheck(const OctreeFile& file)
    : thread_([this, file](const std::stop_token& stop) {
          sentences_ = check_checksums(file, {}, stop);
          done_ = true;
      }) {}

std::optional<Sentences> DamageCheck::take() {
    if (!done_ || !thread_.joinable()) return std::nullopt;
    thread_.join();
    return std::move(sentences_);
}

}  // namespace glowworm
