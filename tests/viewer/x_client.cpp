#include "x_client.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <array>
#include <memory>
#include <stdexcept>

#include "desktop.h"

namespace glowworm::testing {
namespace {

/// A connection to an X server, closed at the end.
class Connection {
  public:
    explicit Connection(const std::string& display) : x_(XOpenDisplay(display.c_str())) {
        if (x_ == nullptr) throw std::runtime_error("no display " + display);
    }
    ~Connection() { XCloseDisplay(x_); }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    operator Display*() const { return x_; }
    Window root() const { return DefaultRootWindow(x_); }
    Atom atom(const char* name) const { return XInternAtom(x_, name, False); }

  private:
    Display* x_;
};

void send(const Connection& x, Window to, Window from, const char* what,
          const std::array<long, 4>& words) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = to;
    event.xclient.message_type = x.atom(what);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(from);
    for (std::size_t i = 0; i < words.size(); ++i)
        event.xclient.data.l[i + 1] = words[i];
    XSendEvent(x, to, False, NoEventMask, &event);
    XFlush(x);
}

/// The next event of a kind, of client messages one of that name; false where none comes.
bool next_event(const Connection& x, int type, const char* message, XEvent& event) {
    return wait_for(
        [&] {
            while (XPending(x) > 0) {
                XNextEvent(x, &event);
                if (event.type != type) continue;
                if (type != ClientMessage || event.xclient.message_type == x.atom(message)) {
                    return true;
                }
            }
            return false;
        },
        30.0);
}

}  // namespace

void set_screen_density(const std::string& display, int dots_per_inch) {
    const Connection x(display);
    const std::string text = "Xft.dpi:\t" + std::to_string(dots_per_inch) + "\n";
    XChangeProperty(x, x.root(), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text.data()),
                    static_cast<int>(text.size()));
    XSync(x, False);
}

bool drop_file(const std::string& display, const std::filesystem::path& file) {
    const Connection x(display);
    Window target = None;
    int ignored = 0;
    XGetInputFocus(x, &target, &ignored);
    const Window source = XCreateSimpleWindow(x, x.root(), 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(x, x.atom("XdndSelection"), source, CurrentTime);

    const Atom list = x.atom("text/uri-list");
    constexpr long kVersion = 5L << 24, kPlace = (20L << 16) | 20L;
    send(x, target, source, "XdndEnter", {kVersion, static_cast<long>(list), 0, 0});
    send(x, target, source, "XdndPosition",
         {0, kPlace, CurrentTime, static_cast<long>(x.atom("XdndActionCopy"))});
    XEvent event;
    if (!next_event(x, ClientMessage, "XdndStatus", event)) return false;
    if ((event.xclient.data.l[1] & 1) == 0) return false;  // it does not want any
    send(x, target, source, "XdndDrop", {0, CurrentTime, 0, 0});
    if (!next_event(x, SelectionRequest, "", event)) return false;

    const XSelectionRequestEvent& asked = event.xselectionrequest;
    const std::string uris = "file://" + file.string() + "\r\n";
    XChangeProperty(x, asked.requestor, asked.property, asked.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(uris.data()),
                    static_cast<int>(uris.size()));
    XEvent answer{};
    answer.xselection.type = SelectionNotify;
    answer.xselection.requestor = asked.requestor;
    answer.xselection.selection = asked.selection;
    answer.xselection.target = asked.target;
    answer.xselection.property = asked.property;
    answer.xselection.time = asked.time;
    XSendEvent(x, asked.requestor, False, NoEventMask, &answer);
    return next_event(x, ClientMessage, "XdndFinished", event);
}

double brightness(const std::string& display, int x, int y, int width, int height) {
    const Connection screen(display);
    const std::unique_ptr<XImage, void (*)(XImage*)> image(
        XGetImage(screen, screen.root(), x, y, static_cast<unsigned>(width),
                  static_cast<unsigned>(height), AllPlanes, ZPixmap),
        [](XImage* i) { XDestroyImage(i); });
    if (!image) throw std::runtime_error("no picture of the screen");
    double sum = 0.0;
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
            const unsigned long pixel = XGetPixel(image.get(), column, row);
            sum += double((pixel & 255) + (pixel >> 8 & 255) + (pixel >> 16 & 255)) / 3.0;
        }
    }
    return sum / (width * height);
}

}  // namespace glowworm::testing
