#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace glowworm {

/// Union-find whose elements are equal or opposite to their root: components of points whose
/// normals agree after some are turned.
class ParityForest {
  public:
    explicit ParityForest(std::size_t n) : link_(n) {
        for (std::size_t i = 0; i < n; ++i)
            link_[i] = static_cast<std::uint32_t>(i) << 1;
    }

    /// Root of element i and whether i is opposite to it. n < 2^31.
    std::pair<std::uint32_t, bool> find(std::uint32_t i) {
        std::uint32_t root = i;
        std::uint32_t parity = 0;
        while (link_[root] >> 1 != root) {
            parity ^= link_[root] & 1;
            root = link_[root] >> 1;
        }
        // Second way up: everyone passed hangs on the root from now on.
        std::uint32_t rest = parity;
        while (i != root) {
            const std::uint32_t link = link_[i];
            link_[i] = root << 1 | rest;
            rest ^= link & 1;
            i = link >> 1;
        }
        return {root, parity != 0};
    }

    /// Joins the components of a and b, which are opposite to each other or equal. The smaller root
    /// stays; nothing happens where they are joined already. Returns whether they were apart.
    bool join(std::uint32_t a, std::uint32_t b, bool opposite) {
        auto [root_a, parity_a] = find(a);
        auto [root_b, parity_b] = find(b);
        if (root_a == root_b) return false;
        if (root_b < root_a) std::swap(root_a, root_b);
        hang(root_b, root_a, parity_a ^ parity_b ^ opposite);
        return true;
    }

    /// Puts the component of one root under another root, to which it is opposite or equal.
    void hang(std::uint32_t root, std::uint32_t under, bool opposite) {
        link_[root] = under << 1 | static_cast<std::uint32_t>(opposite);
    }

  private:
    std::vector<std::uint32_t> link_;  // parent << 1 | opposite to it
};

}  // namespace glowworm
