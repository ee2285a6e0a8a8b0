#pragma once

#include <string>

/// URDFs written for these tests.
namespace made_hands {

/// A gripper as foreign files have them: a fixed base, two sliding fingers of which one follows the
/// other, pads fixed to them, a mesh for the palm (palm.obj beside it), no masses on the pads.
std::string gripper();
/// palm.obj: a block of 60 × 100 × 40 mm, in millimetres (the URDF scales it).
std::string palm_mesh();

/// Three fingers of two joints around a palm and a thumb that stands against them; the distal
/// joints follow by <mimic>, the thumb's base turns without end, tip frames are fixed and empty.
std::string four_fingers();

}  // namespace made_hands
