// The runs of the spreading examples: what they have in common is compiled once.
#include "common/spreading_run.hpp"

namespace tactoid {

template void SpreadingRun::operator()(const SpreadingCase<YangVisco<>>&, const Options&) const;
template void SpreadingRun::operator()(const SpreadingCase<GradedSubstrate>&, const Options&) const;
template void SpreadingRun::operator()(const SpreadingCase<YangVisco<>, 2>&, const Options&) const;

}  // namespace tactoid
