#pragma once

#include <utility>
#include <vector>

namespace glowworm {

/// A state's past and what was undone of it. A new state forgets what was undone.
template <typename T>
class History {
  public:
    explicit History(T state) : state_(std::move(state)) {}

    const T& state() const { return state_; }
    bool can_undo() const { return !past_.empty(); }
    bool can_redo() const { return !undone_.empty(); }

    /// Takes note of `state` as the newest; nothing where it is what is there.
    void record(const T& state) {
        if (state == state_) return;
        past_.push_back(std::exchange(state_, state));
        undone_.clear();
    }
    /// One step back, or forth; the state that is then. Nothing happens at either end.
    const T& undo() { return step(past_, undone_); }
    const T& redo() { return step(undone_, past_); }

  private:
    const T& step(std::vector<T>& from, std::vector<T>& to) {
        if (from.empty()) return state_;
        to.push_back(std::exchange(state_, std::move(from.back())));
        from.pop_back();
        return state_;
    }

    T state_;
    std::vector<T> past_, undone_;
};

}  // namespace glowworm
