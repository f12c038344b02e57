#include "show.h"

namespace pf::capture {

struct Show::Parts {};

Show::Show() = default;
Show::~Show() = default;

void Show::open(const Options& options, const Session&, const std::string&, const std::string&, double,
                std::vector<std::string>& notes) {
  if (options.film || !options.headless) {
    notes.emplace_back("this build draws nothing: it has no Cairo (--headless --no-film says so beforehand)");
  }
}

void Show::add(const FrameView&) {}
void Show::redraw(const FrameView&) {}
bool Show::save(const FrameView&, const std::string&) { return true; }
Key Show::poll(int) { return Key::kNone; }
bool Show::clicked_pixel(double*) const { return false; }
bool Show::is_filming() const { return false; }
bool Show::has_film_failed() const { return false; }
bool Show::close_film() { return true; }

}  // namespace pf::capture
