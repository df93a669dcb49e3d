#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <tactoid/core/ranks.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// Forces on the particles of a body, and row sums of the stiffness there, that one of several processes has found: on their way to the
/// processes to which the particles belong.
class ForcesFound {
 public:
  /// Adds a force (N) on particle i, and what its row of the stiffness sums up to (N/m).
  void add(Index i, const Vector3& force, double stiffness) {
    if (sums_.size() <= i) sums_.resize(i + 1, Vector4::Zero()), touched_.resize(i + 1, 0);
    if (!touched_[i]) touched_[i] = 1, particles_.push_back(i);
    sums_[i].template head<3>() += force;
    sums_[i][3] += stiffness;
  }
  /// Appends what falls on particles of others to the lists for their processes, five numbers for each particle, and forgets it.
  void give(const std::vector<int>& owner, int rank, std::vector<std::vector<double>>& lists) {
    std::erase_if(particles_, [&](Index i) {
      if (owner[i] == rank) return false;
      std::vector<double>& list = lists[static_cast<std::size_t>(owner[i])];
      list.push_back(static_cast<double>(i));
      list.insert(list.end(), sums_[i].data(), sums_[i].data() + 4);
      clear(i);
      return true;
    });
  }
  /// Adds what others have given: list[begin] .. list[end − 1].
  void take(const std::vector<double>& list, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; k += 5) add(static_cast<Index>(list[k]), Vector3(list[k + 1], list[k + 2], list[k + 3]), list[k + 4]);
  }
  /// Adds the forces to those of the body, forgets them, and returns the largest ratio of a row sum to the mass, 1/s².
  double put(const ParticleFields& body) {
    double rate = 0.0;
    for (const Index i : particles_) {
      body.force[i].template head<3>() += sums_[i].template head<3>();
      rate = std::max(rate, sums_[i][3] / body.mass[i]);
      clear(i);
    }
    particles_.clear();
    return rate;
  }

 private:
  void clear(Index i) {
    sums_[i].setZero();
    touched_[i] = 0;
  }
  Field sums_;  // force and stiffness, per particle
  std::vector<char> touched_;
  std::vector<Index> particles_;  // that were touched
};

/// Brings forces that processes have found on two bodies to those that own the particles, and adds them there. Returns the largest ratio of a row sum of the stiffness to
/// the mass on this process, 1/s². Collective.
inline double bring_to_owners(ForcesFound& on_a, const ParticleFields& a, ForcesFound& on_b, const ParticleFields& b) {
  Ranks& ranks = *a.ranks;
  std::vector<std::vector<double>> lists(static_cast<std::size_t>(ranks.size()), std::vector<double>(1));
  on_a.give(*a.owner, ranks.rank(), lists);
  for (std::vector<double>& list : lists) list[0] = static_cast<double>(list.size());  // where those on B begin
  on_b.give(*b.owner, ranks.rank(), lists);
  for (const std::vector<double>& list : ranks.exchange(std::move(lists))) {
    const auto middle = static_cast<std::size_t>(list[0]);
    on_a.take(list, 1, middle);
    on_b.take(list, middle, list.size());
  }
  return std::max(on_a.put(a), on_b.put(b));
}

}  // namespace tactoid
