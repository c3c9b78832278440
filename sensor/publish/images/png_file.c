/* sensor/publish/images/png_file.c: writes PNG files, through libpng. */
#include "sensor/publish/images/image_file_private.h"

#include <png.h>
#include <zlib.h>

/* Measured, 720 x 486, a frame of the demonstration, one core, ms of CPU and kB:
 *
 *                           optical       lwir      truth      radar
 *     filter none           32  453    12  175    3   14    2   21
 *     sub                   30  388    11  155    4   15    4   21
 *     up                    26  485    12  193    6   20    2   30
 *     sub, rle              28  316     9  129    5   11    3   15 (as here)
 *     sub, huffman          20  303     7  127   19  135    7   50 */
static const int png_level = 1, png_filter = PNG_FILTER_SUB, png_strategy = Z_RLE;

static void write_octets(png_structp png, png_bytep octets, size_t count)
{
    if (!image_part_write(png_get_io_ptr(png), octets, count)) png_error(png, "short write");
}

static void nothing_to_flush(png_structp png) { (void)png; }

static void refuse(png_structp png, png_const_charp said)
{
    ImagePart *part = png_get_error_ptr(png);
    snprintf(part->said, sizeof part->said, "%s", said);
    png_longjmp(png, 1);
}

static void no_warning(png_structp png, png_const_charp said)
{
    (void)png;
    (void)said;
}

Status png_file_write(ImagePart *part, const void *values, int width, int height, int channels, int bits)
{
    const size_t   row = (size_t)width * (size_t)channels * (size_t)bits / 8;
    const png_time date = {.year = 1970, .month = 1, .day = 1}; /* two runs give the same octets */
    png_structp    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, part, refuse, no_warning);
    png_infop      info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_write_struct(&png, NULL);
        strcpy(part->said, "out of memory");
        return STATUS_NO_MEMORY;
    }
    if (setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return part->reason ? STATUS_IO : STATUS_NO_MEMORY; /* sizes were looked at: memory alone is left */
    }
    png_set_write_fn(png, part, write_octets, nothing_to_flush);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, png_filter);
    png_set_compression_level(png, png_level);
    png_set_compression_strategy(png, png_strategy);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, bits,
                 channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_oFFs(png, info, 0, 0, PNG_OFFSET_PIXEL); /* says nothing new: files keep the octets that they had */
    png_set_tIME(png, info, &date);
    png_write_info(png, info);
    if (bits == 16) png_set_swap(png); /* the file has the high octet first */
    for (int y = 0; y < height; y++) png_write_row(png, (png_const_bytep)values + (size_t)y * row);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    return STATUS_OK;
}
