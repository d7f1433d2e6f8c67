#include "core/base/non_finite.h"

namespace ulam::detail {

bool note(Cause cause) {
    if (noted == Cause::None) noted = cause;
    return false;
}

}  // namespace ulam::detail
