#pragma once

#include <stdexcept>
#include <string>

namespace glowworm {

/// How a command ends; the numbers are part of the contract with users' scripts.
enum class ExitCode : int {
    kDone = 0,
    kInternal = 1,
    kUsage = 2,
    kUnreadable = 3,      ///< input unreadable or of an unsupported kind
    kDegenerate = 4,      ///< input valid but empty or degenerate
    kNotTrustworthy = 5,  ///< registration not trustworthy (the report is still written)
    kBudget = 6,          ///< memory or disk budget exceeded
    kExists = 7,          ///< output exists and --force was not given
    kCancelled = 8,       ///< cancelled, --resume continues
    kCheckFailed = 9,
};

/// Failure of the world: one full sentence that says what, which file, and what to do. The failure
/// of an algorithm (no overlap, not converged) is data in its result and never thrown.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

}  // namespace glowworm
