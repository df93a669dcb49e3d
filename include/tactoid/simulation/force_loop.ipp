#pragma once

#include <tactoid/simulation/force_loop.hpp>

#if defined(TACTOID_COMPILED)
namespace tactoid {
template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<true>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<false>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<false>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<2, NoDirector, TableEntry>::pass<true>(RegionLaw<YangVisco<>>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<2, DirectorField<>, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<2, DirectorField<>, TableEntry>::pass<true>(RegionLaw<NematicGel<>>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<true>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<false>(RegionLaw<NeoHookean>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<false>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<3, NoDirector, TableEntry>::pass<true>(RegionLaw<YangVisco<>>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<3, DirectorField<>, TableEntry>::pass<true>(RegionLaw<ModifiedMooneyRivlin>&, const PointChunk&, double, bool) const;
template ChunkResult ForceLoop<3, DirectorField<>, TableEntry>::pass<true>(RegionLaw<NematicGel<>>&, const PointChunk&, double, bool) const;
template void ForceLoop<2, NoDirector, TableEntry>::sample(const RegionLaw<NeoHookean>&, std::vector<PointSample>&) const;
template void ForceLoop<2, NoDirector, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
template void ForceLoop<2, NoDirector, TableEntry>::sample(const RegionLaw<YangVisco<>>&, std::vector<PointSample>&) const;
template void ForceLoop<2, DirectorField<>, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
template void ForceLoop<2, DirectorField<>, TableEntry>::sample(const RegionLaw<NematicGel<>>&, std::vector<PointSample>&) const;
template void ForceLoop<3, NoDirector, TableEntry>::sample(const RegionLaw<NeoHookean>&, std::vector<PointSample>&) const;
template void ForceLoop<3, NoDirector, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
template void ForceLoop<3, NoDirector, TableEntry>::sample(const RegionLaw<YangVisco<>>&, std::vector<PointSample>&) const;
template void ForceLoop<3, DirectorField<>, TableEntry>::sample(const RegionLaw<ModifiedMooneyRivlin>&, std::vector<PointSample>&) const;
template void ForceLoop<3, DirectorField<>, TableEntry>::sample(const RegionLaw<NematicGel<>>&, std::vector<PointSample>&) const;
}  // namespace tactoid
#endif
