// The hostile triangles and rays of the stability study, under the tests' names.
#pragma once

#include "studies/stability/hostile.h"

namespace marti::tests {

using studies::Aim;
using studies::all_aims;
using studies::corners;
using studies::hostile_soup;
using studies::Random;
using studies::RayMaker;

}  // namespace marti::tests
