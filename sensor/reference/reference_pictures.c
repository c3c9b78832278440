/* sensor/reference/reference_pictures.c: EXR, PNG, raw counts and range profiles. */
#include "sensor/reference/reference.h"

#include "render/frame/planes.h"

/* ---- EXR ------------------------------------------------------------------------------------- */

/* All planes but the profile, which is a file of its own. */
static bool exr_plane(ReferenceField *out, int i)
{
    static char path[64];
    for (int k = 0; k < plane_row_count; k++) {
        const PlaneRow *row = &plane_rows[k];
        if (row->kind == PLANE_PROFILE || i-- > 0) continue;
        snprintf(path, sizeof path, "channel %s/%s", row->group, row->name);
        *out = (ReferenceField){
            path, row->type == PLANE_F32 ? "float" : "uint", row->unit, row->frame, row->absent, row->about};
        return true;
    }
    return false;
}

static const ReferenceField exr_fields[] = {
    {"header band", "string", "", "", "", "BAND, or `truth`"},
    {"header unit", "string", "", "", "in truth", "`W/(m2 sr)` or `relative`"},
    {"header model", "string", "", "", "but in radar", "`pseudo-radar`"},
    {"header wavelengths_um", "string", "um", "", "except in optical", "wavelengths of each channel"},
    {"header frame", "int", "", "from 0", "", "number of the frame"},
    {"header time_s", "double", "s", "exercise time", "", "instant of the frame"},
    {"header capDate", "string", "", "UTC, YYYY:MM:DD HH:MM:SS", "", "the same as a date; DateTime in OpenImageIO"},
    {"header host", "string", "", "site:application:entity, or `observer`", "", "the host"},
    {"header seed", "int", "", "", "", "of all random numbers"},
    {"header config_sha256", "string", "", "", "", "as in run.json"},
    {"header entity_ids", "string", "", "site:application:entity, separated by commas; the first is entity 1",
     "except in truth", "the frame's entities"},
    {"header material_names", "string", "", "separated by commas; the first is material 1", "except in truth",
     "names of etc/materials.csv"},
    {"header part_names", "string", "", "model:part,part,...;model:... ; the first part is part 1", "except in truth",
     "the parts of the models in this frame"},
    {"header surface_names", "string", "", "separated by commas; the first is surface 1",
     "except in truth; with terrain.woods off", "classes of the ground"},
};

static const ReferenceWord bands[] = {REFERENCE_WORD_BAND};

const Reference reference_exr = {
    .topic = "exr",
    .file = "frames/BAND/NNNNNN.exr",
    .title = "radiance per pixel, and in frames/truth/NNNNNN.exr ground truth per pixel",
    .about = "OpenEXR, scan lines; truth RLE, radar ZIP, others not compressed. Rows from the top, columns from the\n"
             "left: [row][column] of a plane is the pixel whose centre is (column + 0.5, row + 0.5). Truth is that\n"
             "of the sample nearest the centre; radiance is the mean over the pixel.\n"
             "Python: `pip install OpenEXR numpy` (3.3 or later); OpenImageIO reads them as well.",
    .notation = "`channel BAND/NAME`: a channel, float (32 bits) or uint (32 bits, exact); `header NAME`: an "
                "attribute.",
    .listed = exr_plane,
    .field = REFERENCE_FIELDS(exr_fields),
    .word = REFERENCE_FIELDS(bands),
    .python = "import glob, numpy, OpenEXR\n"
              "path = sorted(glob.glob('frames/truth/*.exr'))[0]\n"
              "file = OpenEXR.File(path, separate_channels=True)\n"
              "truth, header = file.channels(), file.header()\n"
              "range_m, entity = truth['range_m'].pixels, truth['entity'].pixels     # [row][column]\n"
              "ids = header['entity_ids'].split(',')\n"
              "for number in numpy.unique(entity[entity > 0]):\n"
              "    seen = entity == number\n"
              "    print(ids[number - 1], int(seen.sum()), 'pixels, nearest', range_m[seen].min(), 'm')\n"
              "lwir = OpenEXR.File(path.replace('truth', 'lwir'), separate_channels=True).channels()['Y'].pixels\n"
              "print('lwir', lwir.mean(), 'W/(m2 sr); sky:', int(numpy.isinf(range_m).sum()), 'pixels')\n",
};

/* ---- PNG ------------------------------------------------------------------------------------- */

static const ReferenceField png_fields[] = {
    {"optical", "RGB 8 bit", "", "sRGB", "with sensor.optical pan or nir, which are grey 8 bit",
     "colour image with the day's white balance and display gamma"},
    {"mwir", "grey 8 bit", "", "", "", "linear between black and white of detector.level; plateau: by its curve"},
    {"lwir", "grey 8 bit", "", "", "", "linear between black and white of detector.level; white is hot"},
    {"radar", "grey 8 bit", "", "", "", "dB: 255 is the brightest of the image, 0 is 60 dB below it or less"},
    {"truth", "RGB 8 bit", "", "", "", "for viewing: a colour per entity, shaded by range"},
};

const Reference reference_png = {
    .topic = "png",
    .file = "frames/BAND/NNNNNN.png",
    .title = "display images, after gain and level",
    .about = "Noise, gain, level and quantisation of the detector.* settings. Same pixels as the EXR. detector.bits: "
             "16\n"
             "makes 16 bits of all but truth. Black and white of an automatic level are in pairs.jsonl (level).\n"
             "With publish.latest, latest/BAND.png is the newest of each band, 8 bits, replaced as a whole.\n"
             "Python: `pip install pillow numpy`.",
    .notation = "Field: folder below frames/. Type: channels and bits of each.",
    .field = REFERENCE_FIELDS(png_fields),
    .python = "import glob, numpy\n"
              "from PIL import Image\n"
              "for path in sorted(glob.glob('frames/lwir/*.png')):\n"
              "    shown = numpy.array(Image.open(path))        # [row][column], RGB: [row][column][3]\n"
              "    row, column = numpy.unravel_index(shown.argmax(), shown.shape)\n"
              "    print(path, shown.dtype, 'brightest at column', column, 'row', row)\n",
};

static const ReferenceField raw_fields[] = {
    {"optical", "RGB 16 bit", "counts", "", "with sensor.optical pan or nir, which are grey 16 bit", "of each channel"},
    {"mwir", "grey 16 bit", "counts", "", "", "of the analogue-to-digital converter"},
    {"lwir", "grey 16 bit", "counts", "", "", "of the analogue-to-digital converter"},
};

const Reference reference_raw = {
    .topic = "raw",
    .file = "raw/BAND/NNNNNN.png",
    .title = "counts of a detector's converter, before gain and level",
    .about = "Of bands that have a sensor (sensor.preset, sensor.table) with detector.raw. Counts from 0, not "
             "rescaled;\n"
             "full scale is 2 to the sensor's number of bits less 1 (bits of etc/sensors.csv), not 65535. Some\n"
             "readers reduce 16-bit RGB to 8 bits (Pillow does); the code below needs no library.",
    .notation = "Field: folder below raw/. Type: channels and bits of each.",
    .field = REFERENCE_FIELDS(raw_fields),
    .python =
        "import glob, struct, zlib\n"
        "def counts(path):\n"
        "    data, at, packed = open(path, 'rb').read(), 8, b''\n"
        "    while at < len(data):\n"
        "        size, kind = struct.unpack('>I4s', data[at:at + 8])\n"
        "        if kind == b'IHDR': width, height, bits, colour = struct.unpack('>IIBB', data[at + 8:at + 18])\n"
        "        if kind == b'IDAT': packed += data[at + 8:at + 8 + size]\n"
        "        at += size + 12\n"
        "    pixel = (3 if colour == 2 else 1) * bits // 8\n"
        "    flat, stride, rows, above = zlib.decompress(packed), width * pixel, [], bytes(width * pixel)\n"
        "    for y in range(height):\n"
        "        how, line = flat[y * (stride + 1)], bytearray(flat[y * (stride + 1) + 1:(y + 1) * (stride + 1)])\n"
        "        for i in range(stride):             # the five filters of PNG\n"
        "            a, b, c = (line[i - pixel], above[i], above[i - pixel]) if i >= pixel else (0, above[i], 0)\n"
        "            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]\n"
        "            line[i] = line[i] + (0, a, b, (a + b) // 2, paeth)[how] & 255\n"
        "        rows.append(struct.unpack('>%dH' % (stride // 2), line))\n"
        "        above = line\n"
        "    return rows                             # [row][column], RGB: [row][3 * column + channel]\n"
        "for path in sorted(glob.glob('raw/lwir/*.png')):\n"
        "    rows = counts(path)\n"
        "    print(path, 'rows', len(rows), 'lowest', min(map(min, rows)), 'highest', max(map(max, rows)))\n",
};

/* ---- range profile --------------------------------------------------------------------------- */

static const ReferenceField profile_fields[] = {
    {"range_m", "number", "m", "from the sensor", "", "centre of the range bin; evenly spaced"},
    {"bounce_1", "number", "relative", "", "", "power reflected once"},
    {"bounce_2", "number", "relative", "", "", "power reflected twice: dihedral corners"},
    {"bounce_3", "number", "relative", "", "", "power reflected three or more times: trihedral corners"},
};

const Reference reference_profile = {
    .topic = "profile",
    .file = "profiles/radar/NNNNNN.csv",
    .title = "power of the pseudo-radar over range, by number of reflections",
    .about = "CSV: lines that begin with # are comments, then a header, then radar.bins rows, the nearest first. "
             "Linear\n"
             "power, of the same relative scale in a whole run.",
    .notation = "Field: column.",
    .field = REFERENCE_FIELDS(profile_fields),
    .python = "import csv, glob, math\n"
              "for path in sorted(glob.glob('profiles/radar/*.csv')):\n"
              "    rows = list(csv.DictReader(line for line in open(path) if not line.startswith('#')))\n"
              "    power = [sum(float(row[f'bounce_{b}']) for b in (1, 2, 3)) for row in rows]\n"
              "    peak = max(range(len(rows)), key=power.__getitem__)\n"
              "    if power[peak] > 0:\n"
              "        print(path, rows[peak]['range_m'], 'm', 10 * math.log10(power[peak]), 'dB over 1')\n",
};

/* ---- the radar with phase ---------------------------------------------------------------------- */

static const ReferenceField radar_fields[] = {
    {"range_m", "number", "m", "from the sensor", "", "middle of the range cell; evenly spaced, the nearest first"},
    {"power_w", "number", "W", "", "", "sum beam, mean of the power of all pulses, noise included"},
    {"re", "number", "sqrt(W)", "", "", "real part of the middle pulse, received as transmitted"},
    {"im", "number", "sqrt(W)", "", "", "its imaginary part"},
    {"cross_re", "number", "sqrt(W)", "", "", "the same in the other polarisation"},
    {"cross_im", "number", "sqrt(W)", "", "", "its imaginary part"},
    {"mti_w", "number", "W", "", "",
     "power behind the canceller of the ground (moving-target indication), whose gain for noise is 1"},
};

const Reference reference_radar = {
    .topic = "radar",
    .file = "radar/NNNNNN.csv",
    .title = "range profile of the radar of radar.preset",
    .about =
        "CSV: lines that begin with # are comments, then a header, then a row a range cell, the nearest first. Voltages\n"
        "at the antenna's port behind the window and its transform, so scaled that an echo's peak squared is its received\n"
        "power. Detections and truth are in truth.jsonl, object radar.",
    .notation = "Field: column.",
    .field = REFERENCE_FIELDS(radar_fields),
    .python = "import csv, glob, math\n"
              "for path in sorted(glob.glob('radar/??????.csv')):\n"
              "    rows = list(csv.DictReader(line for line in open(path) if not line.startswith('#')))\n"
              "    peak = max(rows, key=lambda row: float(row['power_w']))\n"
              "    print(path, peak['range_m'], 'm', 10 * math.log10(float(peak['power_w'])), 'dBW')\n",
};

static const ReferenceField radar_map_fields[] = {
    {"channel sum_re", "float", "sqrt(W)", "", "",
     "map, sum beam; a row a cell of range rate, approaching first, a column a cell of range"},
    {"channel sum_im", "float", "sqrt(W)", "", "", "its imaginary part"},
    {"channel right_re", "float", "sqrt(W)", "", "",
     "difference beam along the camera's columns: over the sum, above 0 right of the axis"},
    {"channel right_im", "float", "sqrt(W)", "", "", "its imaginary part"},
    {"channel down_re", "float", "sqrt(W)", "", "", "difference beam along its rows, above 0 below the axis"},
    {"channel down_im", "float", "sqrt(W)", "", "", "its imaginary part"},
    {"channel cross_re", "float", "sqrt(W)", "", "", "sum beam in the other polarisation"},
    {"channel cross_im", "float", "sqrt(W)", "", "", "its imaginary part"},
    {"header reference_m", "double", "m", "from the sensor", "", "range of column width / 2"},
    {"header reference_rate_mps", "double", "m/s", "above 0: receding", "", "range rate of row height / 2"},
    {"header metre_per_column", "double", "m", "", "", "range"},
    {"header mps_per_row", "double", "m/s", "", "", "range rate"},
    {"header noise_w", "double", "W", "", "", "thermal noise in a cell"},
    {"header unit", "string", "", "", "", "sqrt(W)"},
    {"header radar", "string", "", "", "", "row of etc/radars.csv or radar.table"},
    {"header frame", "int", "", "from 0", "", "number of the frame"},
    {"header time_s", "double", "s", "exercise time", "", "middle of the coherent interval"},
    {"header host", "string", "", "site:application:entity", "", "the entity that carries the radar"},
    {"header capDate", "string", "", "UTC, YYYY:MM:DD HH:MM:SS", "", "instant of the frame; DateTime in OpenImageIO"},
};

const Reference reference_radar_map = {
    .topic = "radar-map",
    .file = "radar/NNNNNN.exr, NNNNNN.png",
    .title = "map of range and Doppler of the radar of radar.preset",
    .about = "Four channels of complex voltage, scaled as the profile's. The PNG has the range profile above and the\n"
             "power of the sum beam below, both in decibels from 5 dB below the noise to the greatest, 45 dB at least.",
    .notation = "Field: `channel` of the EXR file, or `header`: its attribute.",
    .field = REFERENCE_FIELDS(radar_map_fields),
    .python =
        "import glob, math, numpy, OpenEXR\n"
        "for path in sorted(glob.glob('radar/??????.exr')):\n"
        "    file = OpenEXR.File(path, separate_channels=True)\n"
        "    power = file.channels()['sum_re'].pixels ** 2 + file.channels()['sum_im'].pixels ** 2\n"
        "    print(path, power.shape, 10 * math.log10(power.max() / numpy.ravel(file.header()['noise_w'])[0]), 'dB over the noise')\n",
};

static const ReferenceField radar_scan_fields[] = {
    {"channel scan/Y", "float", "W", "", "",
     "real beam: mean power of the pulses of a position, sum beam, noise included; a column a "
     "position, left to right, a row a range cell, the farthest on top"},
    {"channel dbs/Y", "float", "W", "", "out of the window",
     "sharpened by Doppler where that is finer, else the real beam; finer columns, the same rows"},
    {"channel dbs/resolution_m", "float", "m", "across, at half power", "out of the window", "of what stands there"},
    {"channel dbs/sharpened", "float", "", "1, 0", "", "1: by Doppler; 0: the real beam"},
    {"channel view/scan", "float", "W", "", "sky, out of sector or window",
     "real beam at range and azimuth of what the frame's pixel shows"},
    {"channel view/dbs", "float", "W", "", "likewise", "the same, sharpened, for the pixel's own direction"},
    {"header radar", "string", "", "", "", "row of etc/radars.csv"},
    {"header frame", "int", "", "from 0", "", "number of the frame"},
    {"header time_s", "double", "s", "exercise time", "", "middle of the middle position's interval"},
    {"header host", "string", "", "site:application:entity", "", "the entity that carries the radar"},
    {"header interval_s", "double", "s", "", "", "from one position to the next"},
    {"header positions", "int", "", "odd", "", "of the beam"},
    {"header beam_deg", "double", "deg", "", "", "width of the two-way beam at half power"},
    {"header noise_w", "double", "W", "", "", "thermal noise in the real beam"},
    {"header sharp_noise_w", "double", "W", "", "", "thermal noise where it is sharpened, on the axis of a position"},
    {"header reference_m", "double", "m", "from the sensor", "in _view",
     "range of row height / 2 - 1; followed over the positions"},
    {"header metre_per_row", "double", "m", "", "in _view", "range"},
    {"header first_azimuth_deg", "double", "deg", "right positive", "in _view",
     "of the first column, off the camera's axis"},
    {"header azimuth_step_deg", "double", "deg", "", "in _view", "between columns"},
    {"header capDate", "string", "", "UTC, YYYY:MM:DD HH:MM:SS", "", "instant of the frame; DateTime in OpenImageIO"},
};

const Reference reference_radar_scan = {
    .topic = "radar-scan",
    .file = "radar/NNNNNN_scan.exr, NNNNNN_dbs.exr, NNNNNN_view.exr",
    .title = "scan of radar.preset: real beam, sharpened, on pixels",
    .about = "With radar.scan_deg. An echo's peak is its received power. The PNGs of the same names\n"
             "(NNNNNN_view_scan, NNNNNN_view_dbs) show decibels from 5 dB below the noise to the greatest, 45 dB at\n"
             "least; black: no value. _view has the pixels of the band images.",
    .notation = "Field: `channel` FILE/NAME, or `header`: attribute of each file.",
    .field = REFERENCE_FIELDS(radar_scan_fields),
    .python = "import glob, math, numpy, OpenEXR\n"
              "for path in sorted(glob.glob('radar/*_dbs.exr')):\n"
              "    file = OpenEXR.File(path, separate_channels=True)\n"
              "    power, fine = file.channels()['Y'].pixels, file.channels()['sharpened'].pixels\n"
              "    print(path, power.shape, 10 * math.log10(numpy.nanmax(power)), 'dBW;', fine.mean(), 'sharpened')\n",
};

static const ReferenceField radar_azimuth_fields[] = {
    {"az_deg", "number", "deg", "right positive", "", "off the camera's axis; a row a column of NNNNNN_dbs.exr"},
    {"time_s", "number", "s", "from the frame's time", "", "middle of the interval of the position nearest to it"},
    {"resolution_m", "number", "m", "across, at half power", "", "at the reference range"},
    {"sharpened", "number", "", "1, 0", "", "1: by Doppler; 0: the real beam"},
};

const Reference reference_radar_azimuths = {
    .topic = "radar-azimuths",
    .file = "radar/NNNNNN_dbs.csv",
    .title = "resolution of the sharpened scan over azimuth",
    .about = "CSV: lines that begin with # are comments, then a header, then a row an azimuth, left to right.",
    .notation = "Field: column.",
    .field = REFERENCE_FIELDS(radar_azimuth_fields),
    .python = "import csv, glob\n"
              "for path in sorted(glob.glob('radar/*_dbs.csv')):\n"
              "    rows = list(csv.DictReader(line for line in open(path) if not line.startswith('#')))\n"
              "    print(path, min(float(row['resolution_m']) for row in rows), 'm at best')\n",
};
