// A cell adheres to and spreads on a uniform substrate: the main job of Tactoid. See README.md beside this file.
//
//   spreading_uniform --stiffness 10 --end-time 5us --out out/spreading_uniform
//   spreading_uniform --resolution 0.5 --end-time 2us --preset elastic --stiffness 2
//   mpirun -np 4 spreading_uniform --threads 1 …         on several processes, where Tactoid was built with MPI: the same files
#include <tactoid/mpi.hpp>

#include "common/program.hpp"
#include "common/spreading_run.hpp"

int main(int argc, char** argv) {
  using namespace tactoid;
  mpi::Session session(argc, argv);
  return run_program("spreading_uniform", [&] {
    SpreadingParameters p;
    SpreadingRun run{.out = "out/spreading_uniform"};
    double stiffness = 10.0;
    std::string sum_order = "process", set_up = "whole";
    Options options("spreading_uniform",
                    "A cell adheres to and spreads on a uniform substrate (Zeng and Li, Soft Matter 2012, 8, 5765).");
    options.add("stiffness", &stiffness, Range::positive(),
                "Factor on the constants of the base substrate; 2, 5 and 10 are substrates I, II and III");
    p.add_to(options);
    run.add_to(options);
    options.add_choice("sum-order", &sum_order, {"process", "ranks"},
                       "How several processes add up: with the bits of one, or each row once, which is faster and the same but for round-off");
    options.add_choice("set-up", &set_up, {"whole", "divided"},
                       "How several processes make the bodies: each the whole, or its own rows, in less time and memory and with the same results");
    if (!options.parse(argc, argv)) return 0;
    session.set_up = set_up == "divided" ? SetUp::divided : SetUp::whole;
    session.sum_order = sum_order == "ranks" ? SumOrder::of_ranks : SumOrder::of_one_process;
    run(SpreadingCase{p, p.substrate_law(stiffness)}, options);
    return 0;
  });
}
