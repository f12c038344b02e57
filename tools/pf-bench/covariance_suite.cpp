// pf-bench covariance: every operation on the covariance against its flop-and-bytes limit on this core, against syrk of OpenBLAS
// and BLIS, and against the same update written with Eigen and by the textbook.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "blas.h"
#include "covariance/select.h"
#include "covariance_problem.h"
#include "eigen_forms.h"
#include "limits.h"
#include "suite.h"
#include "timing.h"

namespace bench {
namespace {

constexpr const char* kSetNames[] = {"auto", "reference", "portable", "avx2", "avx512", "neon"};

const pf::Kernels* kernels_by_name(const std::string& name) {
  for (std::uint32_t id = 0; id <= 5; ++id) {
    if (name == kSetNames[id] || (id == 0 && name.empty())) return pf::select_kernels(id);
  }
  return nullptr;
}

class CovarianceSuite {
 public:
  CovarianceSuite(const pf::Kernels& kernels, const SuiteOptions& options)
      : kernels_(kernels), options_(options), report_(options), blas_(installed_blas()) {}

  int run() {
    peak_ = peak_flops_per_us();
    report_.note("kernels", kSetNames[pf::kernels_id(&kernels_)]);
    report_.note("peak GFLOP/s", std::to_string(peak_ / 1e3));
    for (const Blas& blas : blas_) report_.note("peer", blas.name);
    for (int n : {100, 200, 300, 400, 600}) {
      for (int m : {10, 20, 40}) update(n, m);
    }
    parts(300, 20);
    parts(300, 60);
    parts(300, 120);
    considered(300, 20);
    moves(300, 20);
    return report_.finish();
  }

 private:
  double bandwidth(int n) const {
    return bandwidth_per_us(static_cast<int>(pf::Triangle::size_for(n) * sizeof(Scalar)));
  }

  void add(const std::string& name, int n, int m, double us, const std::string& peer = "", double peer_us = 1) {
    report_.add({"covariance", name, scalar_name(), n, m, us, peer, peer.empty() ? 0 : us / peer_us});
  }

  Contender own(const std::string& name, Problem& p, std::function<void()> work) {
    return {name, [&p] { p.restore(); }, [&p] { p.P.n = p.n; }, std::move(work)};
  }

  /// The full update, its downdate alone, and everything that can be compared with them, interleaved.
  void update(int n, int m) {
    Problem p(n, m);
    EigenForms eigen(p);
    check(p, eigen);

    std::vector<Contender> all;
    all.push_back(own("update", p, [&] { p.update(kernels_, 0, 0, 0); }));
    all.push_back(own("downdate", p, [&] { kernels_.downdate(p.P, p.W.data(), m, nullptr, nullptr, 0, p.ld, 0, 0); }));
    all.push_back({"eigen rankUpdate", [&] { eigen.restore(); }, [] {}, [&] { eigen.rank_update(); }});
    const std::size_t first_syrk = all.size();
    Aligned square(static_cast<std::size_t>(n) * p.ld);
    for (const Blas& blas : blas_) {
      for (char uplo : {'L', 'U'}) {
        all.push_back({blas.name + " syrk",
                       [&square] { std::memset(square.data(), 0, square.size() * sizeof(Scalar)); }, [] {},
                       [&, uplo] { blas.downdate(uplo, square.data(), p.ld, p.W.data(), m, n, p.ld); }});
      }
    }
    const std::vector<double> us = medians(all, options_.repetitions);
    const double limit = update_limit_us(n, m, static_cast<int>(std::lround(touched_columns(p))), peak_, bandwidth(n));
    add("update", n, m, us[0], "limit", limit);
    double best = 0;
    std::string name;
    for (std::size_t c = first_syrk; c < all.size(); ++c) {
      if (best == 0 || us[c] < best) {
        best = us[c];
        name = all[c].name;
      }
    }
    if (best > 0) {
      add("update", n, m, us[0], name + " (best)", best);
      add("downdate", n, m, us[1], name + " (best)", best);
    }
    add("update", n, m, us[0], all[2].name, us[2]);

    const int few = std::min(options_.repetitions, n > 300 ? 3 : 7);
    const std::vector<double> slow = medians({own("update", p, [&] { p.update(kernels_, 0, 0, 0); }),
                                              {"textbook", [&] { eigen.restore(); }, [] {}, [&] { eigen.textbook(); }}},
                                             few);
    add("update", n, m, slow[0], "textbook", slow[1]);
    const std::vector<double> cold = medians({all[0]}, std::min(options_.repetitions, 15), true);
    add("update, cold cache", n, m, cold[0], "limit", limit);
  }

  /// Both forms must give the same covariance before anybody is timed.
  void check(Problem& p, EigenForms& eigen) {
    p.restore();
    p.update(kernels_, 0, 0, 0);
    eigen.restore();
    eigen.rank_update();
    const double difference = eigen.difference(p.P);
    if (!(difference < (sizeof(Scalar) == 8 ? 1e-9 : 1e-2))) {
      std::fprintf(stderr, "the peers disagree by %g at n = %d, m = %d\n", difference, p.n, p.m);
      std::exit(1);
    }
  }

  /// The steps of one update, each against its own flops.
  void parts(int n, int m) {
    Problem p(n, m);
    p.update(kernels_, 0, 0, 0);
    const std::vector<Scalar> factor(p.S.data(), p.S.data() + p.S.size());
    std::vector<Scalar> S(factor.size());
    const auto square = [&] {
      for (int i = 0; i < m; ++i) {
        for (int j = 0; j <= i; ++j) {
          Scalar sum = 0;
          for (int k = 0; k <= j; ++k) sum += factor[i * m + k] * factor[j * m + k];
          S[i * m + j] = sum;
        }
      }
    };
    square();
    const std::vector<Scalar> product = S;
    Aligned X(p.W.size());
    const std::vector<double> us =
        medians({{"gather", [] {}, [] {},
                  [&] { kernels_.gather_many(p.P, p.J.data(), static_cast<int>(p.J.size()), X.data(), p.ld); }},
                 {"cholesky", [] {}, [&] { S = product; }, [&] { kernels_.cholesky(S.data(), m, m); }},
                 {"solve", [] {}, [&] { std::memcpy(X.data(), p.W.data(), X.size() * sizeof(Scalar)); },
                  [&] { kernels_.solve_lower(factor.data(), m, m, X.data(), n, p.ld); }},
                 own("downdate", p, [&] { kernels_.downdate(p.P, p.W.data(), m, nullptr, nullptr, 0, p.ld, 0, 0); }),
                 own("update", p, [&] { p.update(kernels_, 0, 0, 0); })},
                options_.repetitions);
    const double c = touched_columns(p);
    const double bytes = 1.0 * n * n * static_cast<double>(sizeof(Scalar)) / bandwidth(n);
    add("gather", n, m, us[0], "limit", 2.0 * n * m * c / peak_);
    add("cholesky", n, m, us[1], "limit", 1.0 * m * m * m / 3 / peak_);
    add("solve", n, m, us[2], "limit", 1.0 * n * m * m / peak_);
    add("downdate", n, m, us[3], "limit", 1.0 * n * n * m / peak_ + bytes);
    add("update", n, m, us[4], "sum of its parts", us[0] + us[1] + us[2] + us[3]);
  }

  void considered(int n, int m) {
    Problem p(n, m);
    const std::vector<double> us = medians({own("full", p, [&] { p.update(kernels_, 0, 0, 0); }),
                                            own("half", p, [&] { p.update(kernels_, kBody, kBody + n / 2, 0); }),
                                            own("transport", p, [&] { p.update(kernels_, 0, 0, 4); }),
                                            own("both", p, [&] { p.update(kernels_, kBody, kBody + n / 2, 4); }),
                                            own("transport of 7", p, [&] { p.update(kernels_, 0, 0, 7); })},
                                           options_.repetitions);
    add("update, half considered", n, m, us[1], "update", us[0]);
    add("update, transport of 4", n, m, us[2], "update", us[0]);
    add("update, transport with 4 planes", n, m, us[4], "update", us[0]);
    add("update, half, transport of 4", n, m, us[3], "update, half considered", us[1]);
  }

  /// What happens to the map between updates, each against one update.
  void moves(int n, int m) {
    Problem p(n, m);
    std::vector<Scalar> F(kBody * kBody, Scalar(0.01)), Q(kBody * kBody, Scalar(0.001));
    for (int i = 0; i < kBody; ++i) F[i * kBody + i] = 1;

    pf::StoredRows fold;
    fold.rows = 2;
    fold.segments = 2;
    fold.segment[0] = {kBody, kPoint};
    for (int c = 0; c < 12; ++c) fold.h[c] = Scalar(0.1) * Scalar(c + 1);
    std::vector<int> points;
    std::vector<pf::Segment> blocks, gone;
    std::vector<pf::StoredRows> stored;
    for (int i = 0; i < 20; ++i) {
      points.push_back(kBody + kPoint + kPoint * 4 * i);
      blocks.push_back({points.back(), kPoint});
      fold.segment[1] = blocks.back();
      stored.push_back(fold);
      if (i % 2 == 0) gone.push_back({points.back(), kPoint});
    }
    const std::vector<pf::SparseRows> folds(stored.begin(), stored.end());
    pf::StoredRows fresh;
    fresh.rows = kPoint;
    fresh.segments = 1;
    fresh.segment[0] = {0, 6};
    for (int c = 0; c < 18; ++c) fresh.h[c] = Scalar(0.1);
    const Scalar noise[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    Aligned X(2 * folds.size() * static_cast<std::size_t>(p.ld)), S(4 * folds.size() * folds.size());

    const std::vector<double> us =
        medians({own("update", p, [&] { p.update(kernels_, 0, 0, 0); }),
                 own("predict", p, [&] { kernels_.predict(p.P, F.data(), Q.data(), kBody); }),
                 own("augment 3 rows", p, [&] { kernels_.augment(p.P, fresh, noise); }),
                 own("transform 3 to 2 rows", p,
                     [&] {
                       fold.segment[1] = {points[10], kPoint};
                       kernels_.transform(p.P, points[10], kPoint, fold, nullptr);
                     }),
                 own("fold 20 points", p,
                     [&] {
                       kernels_.transform_many(p.P, blocks.data(), folds.data(), static_cast<int>(folds.size()),
                                               X.data(), p.ld, S.data(), 2 * static_cast<int>(folds.size()));
                     }),
                 own("evict 10 points", p, [&] { kernels_.remove(p.P, gone.data(), static_cast<int>(gone.size())); })},
                options_.repetitions);
    const char* names[] = {"predict", "augment 3 rows", "transform 3 to 2 rows", "fold 20 points", "evict 10 points"};
    for (int i = 0; i < 5; ++i) add(names[i], n, m, us[i + 1], "update", us[0]);
    add("predict", n, kBody, us[1], "limit", 2.0 * n * kBody * kBody / peak_);
  }

  const pf::Kernels& kernels_;
  SuiteOptions options_;
  Report report_;
  std::vector<Blas> blas_;
  double peak_ = 0;
};

int run_covariance(const SuiteOptions& options) {
  const pf::Kernels* kernels = kernels_by_name(options.kernels);
  if (kernels == nullptr) {
    std::fprintf(stderr, "pf-bench: no kernel set '%s' on this processor; --help names them\n",
                 options.kernels.c_str());
    return 2;
  }
  return CovarianceSuite(*kernels, options).run();
}

const Suite covariance_suite("covariance", "the O(n^2) kernels against limits, BLAS, Eigen and the textbook",
                             run_covariance);

}  // namespace
}  // namespace bench
