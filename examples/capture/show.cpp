#include "show.h"

#include "film.h"
#include "overlay.h"
#include "window.h"

namespace pf::capture {

struct Show::Parts {
  Parts(const Session& session, const std::string& title) : overlay(session, title) {}
  Overlay overlay;
  Film film;
  Window window;
};

Show::Show() = default;
Show::~Show() = default;

void Show::open(const Options& options, const Session& session, const std::string& title, const std::string& film,
                double rate_hz, std::vector<std::string>& notes) {
  parts_ = std::make_unique<Parts>(session, title);
  std::string note;
  const int width = parts_->overlay.width();
  const int height = parts_->overlay.height();
  if (options.film && !parts_->film.open(film, width, height, rate_hz, note)) {
    notes.push_back(note);
  }
  if (!options.headless && !parts_->window.open("planefold", width, height, note)) {
    notes.push_back(note);
  }
}

void Show::add(const FrameView& view) {
  parts_->overlay.add(view);
  if (parts_->film.is_open() || parts_->window.is_open()) {
    const Canvas& canvas = parts_->overlay.draw(view);
    parts_->film.add(canvas);
    parts_->window.show(canvas);
  }
}

void Show::redraw(const FrameView& view) { parts_->window.show(parts_->overlay.draw(view)); }

bool Show::save(const FrameView& view, const std::string& path) { return parts_->overlay.draw(view).save_png(path); }

Key Show::poll(int wait_ms) { return parts_->window.poll(wait_ms); }

bool Show::clicked_pixel(double pixel[2]) const {
  double place[2];
  parts_->window.clicked_place(place);
  return parts_->overlay.pixel_at(place, pixel);
}

bool Show::is_filming() const { return parts_->film.is_open(); }

bool Show::has_film_failed() const { return parts_->film.has_failed(); }

bool Show::close_film() { return parts_->film.close(); }

}  // namespace pf::capture
