#pragma once

#include "study.hpp"

namespace tactoid::verification {

// One source file each, named after the study; its helpers have a namespace of their own.
void kernel(Report&, Level);
void statics(Report&, Level);
void locking(Report&, Level);
void vibration(Report&, Level);
void balances(Report&, Level);
void column(Report&, Level);
void viscoelastic(Report&, Level);
void gel_flow(Report&, Level);
void director(Report&, Level);
void active_instability(Report&, Level);
void energy_law(Report&, Level);
void adhesion(Report&, Level);
void drop(Report&, Level);
void bouncing(Report&, Level);
void revolution(Report&, Level);

inline constexpr std::array studies{
    Study{"kernel", "interpolation on jittered clouds, rates", kernel},
    Study{"statics", "manufactured solutions at finite strain, rates", statics},
    Study{"locking", "cantilever of a nearly incompressible material bent by half its length", locking},
    Study{"vibration", "waves and bending of a bar, spheroidal modes of a ball against Lamb", vibration},
    Study{"balances", "energy and momenta over 100000 steps", balances},
    Study{"column", "a column twisted at large deformation", column},
    Study{"viscoelastic", "relaxation and moduli of Yang's branch", viscoelastic},
    Study{"gel_flow", "Couette and Poiseuille flow, the work of a cycle, stresses of a director", gel_flow},
    Study{"director", "anchored bar, Ginzburg-Landau wall, decay of modes, spin and shear", director},
    Study{"active_instability", "spontaneous flow of a contractile channel", active_instability},
    Study{"energy_law", "the energy law of the gel with its director", energy_law},
    Study{"adhesion", "Derjaguin, pull-off from DMT to JKR, Hertz", adhesion},
    Study{"drop", "Laplace pressure, Rayleigh's frequency, Lamb's damping", drop},
    Study{"bouncing", "a ball that bounces in an adhesive potential, two bodies that collide", bouncing},
    Study{"revolution", "bodies of revolution: thick sphere, modes of a ball, ball between plates", revolution},
};

}  // namespace tactoid::verification
