// The hostile triangles and rays of the stability study, under the tests' names.
#pragma once

#include "studies/stability/hostile.h"

namespace marti::tests {

using studies::stability::Aim;
using studies::stability::all_aims;
using studies::stability::corners;
using studies::stability::hostile_soup;
using studies::stability::Random;
using studies::stability::RayMaker;

}  // namespace marti::tests
