#pragma once

#include "base/archive.h"
#include "frame/start/start.h"
#include "model/carry.h"

/// Archive: what the structs of this room hold.

namespace pf {

void carry(Archive& archive, Target& target);
void carry(Archive& archive, KnownBody& known);

}  // namespace pf
