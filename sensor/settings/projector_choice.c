/* sensor/settings/projector_choice.c: what projector.* asks for. */
#include "sensor/settings/projector_choice.h"

bool projector_window_good(const char *text)
{
    enum { least = 16, most = 16384 };
    char        width[8];
    long long   w, h;
    const char *x = strchr(text, 'x');
    if (strcmp(text, "full") == 0) return true;
    if (!x || x - text >= (long)sizeof width) return false;
    memcpy(width, text, (size_t)(x - text));
    width[x - text] = 0;
    return text_to_long(&w, width) && text_to_long(&h, x + 1) && w >= least && w <= most && h >= least && h <= most;
}

Status projector_check(const Config *config)
{
    bool good = true;
    if (config->projector.bits != 8 && config->projector.bits != 16) {
        log_error("config: %sprojector.bits: %d is not 8 or 16", config_where(config, "projector.bits"),
                  config->projector.bits);
        good = false;
    }
    if (!projector_window_good(config->projector.window)) {
        log_error("config: %sprojector.window: '%s' is neither full nor WIDTHxHEIGHT, for example 1280x1024",
                  config_where(config, "projector.window"), config->projector.window);
        good = false;
    }
    if (config->projector.gamepad != PROJECTOR_NO_GAMEPAD && !(*config->projector.band && *config->exercise.head)) {
        log_error("config: %sprojector.gamepad: the projector's window takes it, and exercise.head its poses: with "
                  "--projector BAND and --head ADDRESS:PORT, for example 127.0.0.1:5010",
                  config_where(config, "projector.gamepad"));
        good = false;
    }
#ifndef PITVIPER_SDL
    if (*config->projector.band) {
        log_error(
            "config: %sprojector.band: this program was built without SDL2; install libsdl2-dev and build it again, "
            "or leave it out",
            config_where(config, "projector.band"));
        good = false;
    }
#endif
    return good ? STATUS_OK : STATUS_BAD_VALUE;
}
