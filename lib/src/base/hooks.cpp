#include "base/hooks.h"

namespace pf {

void Hooks::write(const LogPart* part, int parts) const { log(user, LogLine(part, parts).text()); }

}  // namespace pf
