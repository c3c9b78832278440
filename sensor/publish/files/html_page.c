/* sensor/publish/files/html_page.c: reports as one HTML file: its style, its embedded images. */
#include "sensor/publish/files/html_page.h"
#include "pitviper_output.h"
#include "sensor/publish/images/image_file.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <unistd.h>

enum { png_most = 32 << 20 };

static const char style[] =
    ":root{color-scheme:light dark;--line:#8884;--good:#2a7d3f;--bad:#c0392b}\n"
    "body{font:15px/1.45 system-ui,sans-serif;margin:2rem auto;max-width:78rem;padding:0 1rem}\n"
    "h1{font-size:1.5rem}h2{font-size:1.2rem;margin-top:2.2rem}h3{font-size:1rem}\n"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums}\n"
    "td,th{padding:.2rem .7rem;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}\n"
    "td.n,th.n{text-align:right;white-space:nowrap}.good{color:var(--good)}.bad{color:var(--bad);font-weight:600}.dim{"
    "opacity:.65}\n"
    "img{max-width:100%;image-rendering:pixelated}figure{display:inline-block;margin:.3rem .8rem .8rem 0}\n"
    "figcaption{font-size:.85rem}code{font-family:ui-monospace,monospace}\n";

FILE *html_begin(const char *path, const char *title) { return html_begin_styled(path, title, ""); }

FILE *html_begin_styled(const char *path, const char *title, const char *rules)
{
    FILE *page = output_begin(path, OUTPUT_STREAM);
    if (!page) {
        log_error("report: cannot write %s: %s; choose another place", path, output_reason(errno));
        return NULL;
    }
    fputs("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width\">\n<title>",
          page);
    html_text(page, "%s", title);
    fprintf(page, "</title>\n<style>\n%s%s</style></head><body>\n<h1>", style, rules);
    html_text(page, "%s", title);
    fputs("</h1>\n", page);
    return page;
}

static void escape(FILE *page, const char *text)
{
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", page);
            break;
        case '<':
            fputs("&lt;", page);
            break;
        case '>':
            fputs("&gt;", page);
            break;
        case '"':
            fputs("&quot;", page);
            break;
        default:
            fputc(*text, page);
        }
    }
}

void html_text(FILE *page, const char *format, ...)
{
    char   *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    const int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    if (length < 0) {
        fputs("(out of memory)", page);
        return;
    }
    escape(page, text);
    free(text);
}

void html_image(FILE *page, const char *type, const void *bytes, size_t count, const char *alt)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const uint8_t    *b = bytes;
    fprintf(page, "<img src=\"data:image/%s;base64,", type);
    for (size_t i = 0; i < count; i += 3) {
        const size_t   left = count - i;
        const uint32_t v = (uint32_t)b[i] << 16 | (left > 1 ? (uint32_t)b[i + 1] << 8 : 0) | (left > 2 ? b[i + 2] : 0u);
        fputc(digits[v >> 18], page);
        fputc(digits[v >> 12 & 63], page);
        fputc(left > 1 ? digits[v >> 6 & 63] : '=', page);
        fputc(left > 2 ? digits[v & 63] : '=', page);
    }
    fputs("\" alt=\"", page);
    escape(page, alt);
    fputs("\">", page);
}

bool html_png(FILE *page, const void *values, int width, int height, int channels, int bits, const char *scratch,
              const char *alt)
{
    char  *bytes;
    size_t octets;
    if (image_write_png(scratch, values, width, height, channels, bits) != STATUS_OK) return false;
    const bool ok = text_read_file(&bytes, &octets, "report", scratch, png_most) == STATUS_OK;
    unlink(scratch);
    if (!ok) return false;
    html_image(page, "png", bytes, octets, alt);
    free(bytes);
    return true;
}

Status html_end(FILE *page, const char *path)
{
    fputs("</body></html>\n", page);
    if (output_end(page, path)) return STATUS_OK;
    log_error("report: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}
