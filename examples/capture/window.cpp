#include "window.h"

#include <cstdlib>
#include <cstring>

#ifdef PLANEFOLD_HAVE_SDL2
#include <SDL.h>
#endif

namespace pf::capture {

#ifdef PLANEFOLD_HAVE_SDL2

struct Window::Parts {
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  SDL_Texture* texture = nullptr;

  ~Parts() {
    SDL_DestroyTexture(texture);
    SDL_DestroyRenderer(renderer);
    SDL_DestroyWindow(window);
    SDL_Quit();
  }
};

bool Window::open(const std::string& title, int width, int height, std::string& why) {
  // Without a display SDL could still find a driver that draws nowhere, or take over a console.
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr &&
      std::getenv("SDL_VIDEODRIVER") == nullptr) {
    why = "no display; going on without a window (--headless says so beforehand)";
    return false;
  }
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  if (SDL_Init(SDL_INIT_VIDEO) != 0) {
    why = std::string("no window: ") + SDL_GetError() + "; going on without";
    return false;
  }
  // Without a desktop there often is OpenGL ES alone, and SDL would take its empty functions for those of OpenGL.
  const char* driver = SDL_GetCurrentVideoDriver();
  if (driver != nullptr && std::strcmp(driver, "KMSDRM") == 0) {
    SDL_SetHint(SDL_HINT_RENDER_DRIVER, "opengles2");
  }
  auto parts = std::make_unique<Parts>();
  parts->window = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, width, height,
                                   SDL_WINDOW_RESIZABLE);
  parts->renderer = parts->window != nullptr ? SDL_CreateRenderer(parts->window, -1, 0) : nullptr;
  if (parts->renderer != nullptr) {
    SDL_RenderSetLogicalSize(parts->renderer, width, height);
    parts->texture =
        SDL_CreateTexture(parts->renderer, SDL_PIXELFORMAT_RGB888, SDL_TEXTUREACCESS_STREAMING, width, height);
  }
  if (parts->texture == nullptr) {
    why = std::string("no window: ") + SDL_GetError() + "; going on without";
    return false;
  }
  parts_ = std::move(parts);
  return true;
}

void Window::show(const Canvas& canvas) {
  if (parts_ == nullptr) {
    return;
  }
  SDL_UpdateTexture(parts_->texture, nullptr, canvas.pixels(), canvas.stride());
  SDL_RenderClear(parts_->renderer);
  SDL_RenderCopy(parts_->renderer, parts_->texture, nullptr, nullptr);
  SDL_RenderPresent(parts_->renderer);
}

Key Window::poll(int wait_ms) {
  SDL_Event event;
  while (parts_ != nullptr && (wait_ms > 0 ? SDL_WaitEventTimeout(&event, wait_ms) : SDL_PollEvent(&event)) != 0) {
    if (event.type == SDL_QUIT) {
      return Key::kQuit;
    }
    // A tap comes as a click of the left button. The renderer's logical size makes these places of the picture.
    if (event.type == SDL_MOUSEMOTION) {
      click_[0] = event.motion.x;
      click_[1] = event.motion.y;
    }
    if (event.type == SDL_MOUSEBUTTONDOWN && event.button.button == SDL_BUTTON_LEFT) {
      click_[0] = event.button.x;
      click_[1] = event.button.y;
      return Key::kClick;
    }
    if (event.type == SDL_KEYDOWN) {
      switch (event.key.keysym.sym) {
        case SDLK_SPACE:
          return Key::kPause;
        case SDLK_a:
          return Key::kAnchor;
        case SDLK_r:
          return Key::kReset;
        case SDLK_s:
          return Key::kSave;
        case SDLK_q:
        case SDLK_ESCAPE:
          return Key::kQuit;
        default:
          break;
      }
    }
    wait_ms = 0;
  }
  return Key::kNone;
}

#else

struct Window::Parts {};

bool Window::open(const std::string&, int, int, std::string& why) {
  why = "built without SDL2; going on without a window";
  return false;
}
void Window::show(const Canvas&) {}
Key Window::poll(int) { return Key::kNone; }

#endif

Window::Window() = default;
Window::~Window() = default;

}  // namespace pf::capture
