#include "covariance/select.h"

#include "covariance/tuned/sets.h"

namespace pf {
namespace {

// pf_kernels_t
enum : uint32_t { kAuto, kReference, kPortable, kAvx2, kAvx512, kNeon };

#if defined(__x86_64__)

struct Cpuid {
  uint32_t eax, ebx, ecx, edx;
};

Cpuid cpuid(uint32_t leaf) {
  Cpuid r;
  asm volatile("cpuid" : "=a"(r.eax), "=b"(r.ebx), "=c"(r.ecx), "=d"(r.edx) : "a"(leaf), "c"(0));
  return r;
}

/// Registers that the operating system saves; XCR0.
uint32_t saved_registers() {
  uint32_t low, high;
  asm volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

/// The set needs the processor's instructions and an operating system that saves their registers.
bool runs(uint32_t set) {
  constexpr uint32_t kFma = 1u << 12, kOsxsave = 1u << 27, kAvx = 1u << 28;
  constexpr uint32_t kBitAvx2 = 1u << 5, kAvx512F = 1u << 16, kAvx512Dq = 1u << 17, kAvx512Vl = 1u << 31;
  constexpr uint32_t kYmm = 0x06, kZmm = 0xe6;
  if (cpuid(0).eax < 7) return false;
  const uint32_t basic = kFma | kOsxsave | kAvx;
  if ((cpuid(1).ecx & basic) != basic) return false;
  const uint32_t wanted = set == kAvx2 ? kBitAvx2 : kBitAvx2 | kAvx512F | kAvx512Dq | kAvx512Vl;
  const uint32_t registers = set == kAvx2 ? kYmm : kZmm;
  return (cpuid(7).ebx & wanted) == wanted && (saved_registers() & registers) == registers;
}

#endif

/// Null where this build has no such set.
const Kernels* built(uint32_t set) {
  switch (set) {
    case kReference:
      return &reference_kernels();
    case kPortable:
      return &portable_kernels();
#if defined(PF_HAS_AVX2)
    case kAvx2:
      return &avx2_kernels();
    case kAvx512:
      return &avx512_kernels();
#endif
#if defined(PF_HAS_NEON)
    case kNeon:
      return &neon_kernels();
#endif
    default:
      return nullptr;
  }
}

const Kernels* find(uint32_t set) {
#if defined(PF_HAS_AVX2)
  if ((set == kAvx2 || set == kAvx512) && !runs(set)) return nullptr;
#endif
  return built(set);
}

}  // namespace

const Kernels* select_kernels(uint32_t wanted) {
  if (wanted != kAuto) return find(wanted);
  for (uint32_t set = kNeon; set > kPortable; --set) {
    const Kernels* kernels = find(set);
    if (kernels != nullptr) return kernels;
  }
  return &portable_kernels();
}

uint32_t kernels_id(const Kernels* kernels) {
  for (uint32_t set = kReference; set <= kNeon; ++set) {
    if (kernels != nullptr && kernels == built(set)) return set;
  }
  return kAuto;
}

}  // namespace pf
