// How often a frame's lines are used again, recovered from the misses of a few caches.
//
// Sources: A. J. Smith, A comparative study of set associative memory mapping algorithms, IEEE Transactions
// on Software Engineering 4(2), 1978, and M. D. Hill, A. J. Smith, Evaluating associativity in CPU caches,
// IEEE Transactions on Computers 38(12), 1989 (misses of set-associative caches from reuse distances); D. D.
// Lee, H. S. Seung, Algorithms for non-negative matrix factorization, NIPS 13, 2001 (the least-squares fit).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace marti::studies::limits {

/// Misses of a cache with this shape. All caches of a fit have the same lines and see the same references.
struct CacheMisses {
  double sets = 1.0;
  double ways = 1.0;
  double misses = 0.0;  ///< above 0
};

class ReuseDistances {
 public:
  /// A smooth distribution whose misses are near to these, by the sum of squared relative errors.
  explicit ReuseDistances(std::span<const CacheMisses> caches);

  /// Of a cache with `sets` sets, at least 1, and `ways` ways, at least 1.
  [[nodiscard]] double misses(double sets, double ways) const;

 private:
  // Half powers of two, up to 64 Mi lines; the last stands for lines that are used for the first time.
  static constexpr std::size_t distances = 53;
  using Row = std::array<double, distances>;  // a value for each distance
  [[nodiscard]] static Row miss_shares(double sets, double ways);
  void improve(const std::vector<Row>& rows, const Row& wanted, std::vector<double>& fitted);

  Row references_{};  // with this number of other lines since the last use
};

}  // namespace marti::studies::limits
