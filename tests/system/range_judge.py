"""Ranges of detection, recognition and identification by programs of others: pyBSM's transfer functions, electrons and signal
to noise; Barten's model of 1999 by colour-science; and the TTP value, bar contrast and probabilities by formulae written down
here again, from the papers, with scipy's quadrature. pyBSM (0.16.1) has image quality (GIQE, NIIRS), but neither MRTD nor TTP.

    range_judge.py PITVIPER FOLDER        FOLDER: of range.csv for each sensor, as test_range_judge.sh makes them

Prints a line a comparison: what, how many values, the greatest difference."""
import csv
import io
import os
import subprocess
import sys
import types

import numpy as np
from scipy import integrate

os.environ['NUMBA_DISABLE_JIT'] = '1'
plots = {name: types.ModuleType(name) for name in ('matplotlib', 'matplotlib.pyplot')}
sys.modules.update(plots)  # pyBSM imports them, for plots alone
from pybsm.otf import functional as otf  # noqa: E402
from pybsm.radiance import functional as radiance  # noqa: E402

for name in plots:
    del sys.modules[name]
import colour.contrast as eyes  # noqa: E402

PITVIPER, FOLDER = sys.argv[1:3]
H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23


def probe(name, header, rows):
    text = header + '\n' + ''.join(','.join(str(v) for v in row) + '\n' for row in rows)
    out = subprocess.run([PITVIPER, 'probe', name], input=text, capture_output=True, text=True, check=True).stdout
    return list(csv.DictReader(io.StringIO(out)))


def say(what, got, want, relative=True):
    got, want = np.asarray(got, float), np.asarray(want, float)
    print(what, len(got), '%.3g' % np.max(np.abs(got - want) / (np.abs(want) if relative else 1)))


# ---- transfer: focal length 1 m, frequencies in cycles a radian ----------------------------------------------------
def at(pitch_m, f_px):
    return np.atleast_2d(np.asarray(f_px, float) / pitch_m), np.zeros((1, np.size(f_px)))


def optics(wavelength_m, f_number, obscuration, pitch_m, f_px):
    u, v = at(pitch_m, f_px)
    return otf.circular_aperture_OTF(u=u, v=v, lambda0=wavelength_m, D=1 / f_number, eta=obscuration)[0]


def detector(width_m, pitch_m, f_px):
    u, v = at(pitch_m, f_px)
    return otf.detector_OTF(u=u, v=v, w_x=width_m, w_y=width_m, f=1.0)[0]


def smear(px, pitch_m, f_px):
    u, v = at(pitch_m, f_px)
    return otf.drift_OTF(u=u, v=v, a_x=px * pitch_m, a_y=0.0)[0]


def jitter(px, pitch_m, f_px):
    u, v = at(pitch_m, f_px)
    return otf.jitter_OTF(u=u, v=v, s_x=px * pitch_m, s_y=px * pitch_m)[0]


rows, want = [], []
for wavelength, f_number, obscuration, pitch in ((10, 2, 0, 25), (4.3, 4, 0, 15), (9.8, 2.5, 0.3, 50.8), (0.55, 4, 0.5, 12)):
    for smear_px, jitter_px in ((0.001, 0.001), (0.7, 0.2), (1.5, 0.5)):
        for f in np.linspace(0.02, 0.5, 13):
            rows.append((wavelength, f_number, obscuration, pitch, smear_px, jitter_px, f))
            p = pitch * 1e-6
            parts = [optics(wavelength * 1e-6, f_number, obscuration, p, [f]), detector(p, p, [f]), smear(smear_px, p, [f]),
                     jitter(jitter_px, p, [f])]
            want.append([float(np.real(part[0])) for part in parts])
names = ('mtf_optics', 'mtf_detector', 'mtf_smear', 'mtf_jitter')
found = probe('mtf', 'wavelength_um,f_number,obscuration,pitch_um,smear_px,jitter_px,f_cyc_px', rows)
for k, name in enumerate(names):
    say(name, [float(r[name]) for r in found], [w[k] for w in want], False)
say('mtf', [float(r['mtf']) for r in found], [np.prod(w) for w in want], False)

# ---- electrons, and signal over noise of 1 K ------------------------------------------------------------------------
rows, electrons, snr = [], [], []
for low, high, f_number, transmission, qe, pitch, ms, dark, read in (
        (8, 12, 2, 0.8, 0.7, 25, 0.1, 5e5, 1000), (3.4, 4.8, 4, 0.8, 0.7, 15, 5, 5e3, 400), (8, 12, 2.5, 0.7, 0.6, 50.8, 0.017, 0, 13000)):
    for temp in (260, 288, 320):
        rows.append((low, high, temp, f_number, transmission, qe, pitch, ms, dark, read))
        w = np.linspace(low * 1e-6, high * 1e-6, 4001)
        n = []
        for t in (temp, temp - 0.01, temp + 0.01):
            e = radiance.at_focal_plane_irradiance(D=1 / f_number, f=1.0, L=radiance.blackbody_radiance(lambda0=w, T=t) * transmission)
            rate = radiance.photon_detection_rate(E=e, w_x=pitch * 1e-6, w_y=pitch * 1e-6, wavelengths=w, qe=np.full_like(w, qe))
            n.append(integrate.trapezoid(rate, w) * ms * 1e-3)
        electrons.append(n[0])
        snr.append((n[2] - n[1]) / 0.02 / np.sqrt(n[0] + dark + read**2))
found = probe('netd', 'lo_um,hi_um,temp_k,f_number,transmission,qe,pitch_um,integration_ms,dark_e,read_e', rows)
say('electrons', [float(r['electrons']) for r in found], electrons)
say('snr', [1e3 / float(r['netd_mk']) for r in found], snr)


# ---- the eye: Barten (1990), and his full model of 1999 ---------------------------------------------------------------
def threshold(u, luminance, field):
    a = 540 * (1 + 0.7 / luminance)**-0.2 / (1 + 12 / (field * (1 + u / 3)**2))
    b = 0.3 * (1 + 100 / luminance)**0.15
    return 1 / (a * u * np.exp(-b * u) * np.sqrt(1 + 0.06 * np.exp(b * u)))


def transfer(f_mrad, luminance):
    d = -9.011 + 13.23 * np.exp(-np.log10(luminance / 3.4262590996) / 21.082) - 0.5
    f0 = np.exp(3.663 - 0.0216 * d**2 * np.log(d)) / 43.69
    return np.exp(-(f_mrad / f0)**((0.7155 + 0.277 / np.sqrt(d))**2) - 0.375 * f_mrad**1.21 - 0.4441 * f_mrad**2)


grid = [(u, luminance, field) for u in (0.5, 1, 2, 4, 8, 15, 20, 30) for luminance in (3, 34.26, 300) for field in (10, 25)]
found = probe('eye', 'f_cyc_deg,luminance_cd_m2,field_deg', grid)
say('eye_threshold', [float(r['threshold']) for r in found], [threshold(*g) for g in grid])
say('eye_transfer', [float(r['transfer']) for r in found], [transfer(g[0] / (1e3 * np.radians(1)), g[1]) for g in grid])
ratio = {1: [], 4: []}  # by the least frequency
for r, (u, luminance, field) in zip(found, grid):
    if not 1 <= u <= 20 or luminance < 30:
        continue
    pupil = eyes.pupil_diameter_Barten1999(luminance, field)
    full = eyes.contrast_sensitivity_function_Barten1999(
        u=u, sigma=eyes.sigma_Barten1999(0.5 / 60, 0.08 / 60, pupil), E=eyes.retinal_illuminance_Barten1999(luminance, pupil),
        X_0=field, X_max=12, Y_0=field, Y_max=12)
    for least in ratio:
        if u >= least:
            ratio[least].append(float(r['threshold']) * float(full))
for least, all_of in ratio.items():
    print('barten_1999_from_%d' % least, len(all_of), '%.3g' % np.exp(np.max(np.abs(np.log(all_of)))))

# ---- TTP by Vollmerhausen & Jacobs (2004), from rows of etc/sensors.csv ----------------------------------------------
with open('etc/sensors.csv', encoding='utf-8') as file:
    SENSORS = {r['name']: r for r in csv.DictReader(line for line in file if not line.startswith('#'))}
BANDS = {'mwir': (3.4e-6, 4.8e-6), 'lwir': (8e-6, 12e-6), 'optical': (0.4e-6, 0.7e-6), 'swir': (1.0e-6, 1.7e-6)}


def planck_photons(w, temp):
    return 2 * C / w**4 / np.expm1(H * C / (w * K * temp))


class Sensor:
    """What the model takes of a sensor: transfer in cycles a pixel, and noise in the unit of the contrast."""

    def __init__(self, name, temp_k=288.0, frame_hz=30.0, eye_s=0.2):
        r = {k: float(v) if k not in ('name', 'band', 'exposure', 'scan', 'source') else v for k, v in SENSORS[name].items()}
        self.r, self.pitch = r, r['pitch_um'] * 1e-6
        low, high = BANDS[r['band']]
        emits = r['band'] in ('mwir', 'lwir')
        mean = lambda t: integrate.quad(lambda w: w * planck_photons(w, t), low, high)[0] / \
            integrate.quad(lambda w: planck_photons(w, t), low, high)[0]  # noqa: E731
        self.wavelength = mean(300 if emits else 5772)
        self.scene = 5.0 if emits else 1.0
        self.ifov = 2 * np.tan(np.radians(r['hfov_deg']) / 2) / r['width_px']
        stages, t = r['tdi'], r['integration_ms'] * 1e-3
        k = np.pi / (4 * r['f_number']**2 + 1) * self.pitch**2 * r['transmission'] * r['qe'] * t * stages
        count = lambda temp: k * integrate.quad(lambda w: planck_photons(w, temp), low, high, epsrel=1e-10)[0]  # noqa: E731
        floor = r['dark_e_s'] * t * stages + r['read_e']**2 * stages
        step = r['well_e'] / (2**r['bits'] - 1)
        if emits:
            signal = count(temp_k)
            self.unit = (count(temp_k + 0.05) - count(temp_k - 0.05)) / 0.1
            reference = count(300)
        else:  # exposed to 0.35 of the well; dark current in that time counts for nothing
            signal = self.unit = reference = 0.35 * r['well_e']
        ref2 = (reference if r['exposure'] == 'fixed' else 0.35 * r['well_e']) + floor
        self.white = (signal + (floor if emits else r['read_e']**2 * stages) + step**2 / 12) / frame_hz
        gain = (r['prnu'] * signal)**2
        swept = r['scan'] == 'columns'
        self.white += (ref2 * r['vh']**2 + (0 if swept else gain)) * eye_s
        self.columns = ref2 * (r['th']**2 / frame_hz + r['h']**2 * eye_s)
        self.rows = ref2 * (r['tv']**2 / frame_hz + r['v']**2 * eye_s) + (gain * eye_s if swept else 0)
        self.line, self.reach = ref2 * r['line_noise']**2 * eye_s / min(frame_hz * eye_s, 10), r['line_noise_px']
        self.sweep = t / (r['line_us'] * 1e-6) if swept else 0
        self.px_mrad = 1e3 * 0.4 / r['height_px']
        self.field = np.degrees(1e-3 * self.px_mrad) * np.sqrt(r['width_px'] * r['height_px'])

    def mtf(self, axis, f):
        r = self.r
        h = optics(self.wavelength, r['f_number'], r['obscuration'], self.pitch, [f])[0] * \
            detector(r['footprint'] * self.pitch, self.pitch, [f])[0]
        if r['jitter_px'] > 0:
            h *= np.real(jitter(r['jitter_px'], self.pitch, [f])[0])
        if axis == 0 and self.sweep > 0:
            h *= np.real(smear(self.sweep, self.pitch, [f])[0])
        return float(np.real(h))

    def passed(self, f):
        return (np.sinc(f) * transfer(f / self.px_mrad, 34.26))**2

    def lorentz(self, f):
        return 2 * self.reach / (1 + (2 * np.pi * self.reach * f)**2) if self.reach > 0.5 else 1.0

    def across(self, line):
        power = (lambda f: self.passed(f) * self.lorentz(f)) if line else self.passed
        edges = [0] + [10.0**k for k in range(-4, 0)] + list(np.arange(0.5, 8 * self.px_mrad, 0.5))
        return 2 * sum(integrate.quad(power, a, b)[0] for a, b in zip(edges, edges[1:]))

    def channel(self, f, line):
        power = lambda x: np.exp(-4.4 * x**2) * self.passed(f * np.exp(x)) * \
            (self.lorentz(f * np.exp(x)) if line else 1) * f * np.exp(x)  # noqa: E731
        return 2 * integrate.quad(power, -3.5, 3.5, epsrel=1e-6)[0]

    def curve(self):
        """ln f and CTF of both axes, fine enough that the integral's own step does not count."""
        f = np.exp(np.linspace(np.log(1e-3), np.log(0.5), 200))
        every, every_line = self.across(False), self.across(True) if self.line else 0
        seen = np.array([self.channel(x, False) for x in f])
        seen_line = np.array([self.channel(x, True) for x in f]) if self.line else 0
        noise = [(self.white * every + self.columns) * seen + self.line * seen_line * every,
                 (self.white * every + self.rows) * seen + self.line * seen * every_line]
        eye = threshold(f / self.px_mrad * 1e3 * np.radians(1), 34.26, self.field)
        return f, [eye / (np.array([self.mtf(a, x) for x in f]) * np.sinc(f)) *
                   np.sqrt(1 + (169.6 / self.scene / self.unit)**2 * noise[a]) for a in range(2)]


def ttp(curve, c):
    f, ctf = curve
    whole = 1
    x = np.linspace(np.log(f[0]), np.log(f[-1]), 40001)
    for one in ctf:
        y = c / np.exp(np.interp(x, np.log(f), np.log(one)))
        whole *= integrate.trapezoid(np.where(y > 1, np.sqrt(y), 0) * np.exp(x), x)
    return np.sqrt(whole)


got, want = [], []
CURVES = {}
for name in ('staring_lwir', 'staring_mwir', 'scanning_flir', 'scanning_flir2', 'tv', 'staring_swir'):
    s = Sensor(name)
    CURVES[name] = s, s.curve()
    contrasts = (0.1, 0.5, 2.0, 9.0) if s.scene == 5 else (0.02, 0.1, 0.3, 1.5)
    found = probe('acquisition', 'preset,contrast', [(name, c) for c in contrasts])
    got += [float(r['ttp_px']) for r in found]
    want += [ttp(CURVES[name][1], min(c / (2 * s.scene), 1)) for c in contrasts]
say('ttp', got, want)


# ---- range.csv: cycles by the MRTD that `probe mrtd` gives, TTP by the curves above, probabilities, ranges of half ---------
def johnson(x):
    e = 2.7 + 0.7 * x
    return x**e / (1 + x**e)


def ttpf(x):
    e = 1.51 + 0.24 * x
    return x**e / (1 + x**e)


def resolved(name, contrast):
    """Both bars' highest frequency, by halving."""
    f = np.linspace(0.01, 0.5, 500)
    table = probe('mrtd', 'preset,f_cyc_px,temp_k', [(name, x, 288.15) for x in f])
    both = 1
    for bars in ('mrtd_v_bars_k', 'mrtd_h_bars_k'):
        k = np.array([float(r[bars]) if r[bars] else np.inf for r in table])
        both = both * np.array([f[np.nonzero(k <= c)[0].max()] if (k <= c).any() else 0 for c in contrast])
    return np.sqrt(both)


def left(length):
    return (1 - 1 / (3 * length)) / length if length > 1 else 1 - length / 3


def contrast_resolved(s, f):
    """The least contrast of both bars that an observer resolves, of a sensor without noise along its lines."""
    w, e2 = 0.5 / f, []
    for strips in (s.columns, s.rows):
        e2.append((s.white * left(w) * left(7 * w) + strips * left(w)) / 0.2)
    bars = [8 / np.pi**2 * sum(s.mtf(axis, n * f) * np.sinc(n * f) / n**2 for n in range(1, 16, 2)) for axis in range(2)]
    return [2.5 * np.sqrt(e2[axis]) / s.unit / bars[axis] for axis in range(2)]


got, want = [], []
for name, contrasts in (('tv', (0.01, 0.02, 0.04)), ('staring_swir', (0.005, 0.01, 0.02)), ('staring_mwir', (0.03, 0.06, 0.1))):
    s = CURVES[name][0]
    f = np.linspace(0.02, 0.5, 481)
    least = np.array([contrast_resolved(s, x) for x in f])
    found = probe('acquisition', 'preset,contrast', [(name, c) for c in contrasts])
    got += [float(r['cycles_px']) for r in found]
    want += [np.sqrt(np.prod([f[np.nonzero(least[:, axis] <= c)[0].max()] for axis in range(2)])) for c in contrasts]
say('cycles', got, want)

for name in ('staring_lwir', 'scanning_flir', 'tv'):
    with open(os.path.join(FOLDER, name, 'range.csv'), encoding='utf-8') as file:
        table = [{k: float(v) for k, v in r.items()} for r in csv.DictReader(file)]
    s, curve = CURVES[name]
    table = [r for r in table[1:] if r['range_m'] > 200]
    size_px = np.array([2.3 / (r['range_m'] * s.ifov) for r in table])
    contrast = np.array([r['contrast'] for r in table])
    if s.scene == 5:
        say('range_contrast_' + name, contrast, [2 * r['transmittance'] for r in table])
        cycles = resolved(name, contrast)
        some = cycles > 0.05
        say('range_cycles_' + name, np.array([r['cycles'] for r in table])[some] / size_px[some], cycles[some])
        some = [i for i, r in enumerate(table) if r['ttp_v'] / size_px[i] > 0.05][::10]
        say('range_ttp_' + name, [table[i]['ttp_v'] for i in some], [size_px[i] * ttp(curve, contrast[i] / 10) for i in some])
    else:  # what the air adds to a lit background takes contrast away; light and air as other probes have them
        sun = probe('sunlight', 'model,visibility_km,band,observer_m,sun_zenith_deg', [('us1976', 23, 'pan', 0, 45)])[0]
        lit = 0.2 / np.pi * (float(sun['direct_w_m2']) * np.sin(np.radians(45)) + float(sun['diffuse_w_m2']))
        air = probe('atmosphere', 'model,visibility_km,band,observer_m,target_m,range_km,temp_k,sun_zenith_deg,rel_azimuth_deg',
                    [('us1976', 23, 'pan', 2, 1, r['range_m'] / 1000, 288, 45, 90) for r in table])
        seen, added = lit * np.array([float(a['sun_tau']) for a in air]), np.array([float(a['scattered']) for a in air])
        say('range_contrast_' + name, contrast, 0.3 * seen / (seen + added))
        some = [i for i, r in enumerate(table) if r['ttp_v'] / size_px[i] > 0.05][::10]
        say('range_ttp_' + name, [table[i]['ttp_v'] for i in some], [size_px[i] * ttp(curve, contrast[i] / 2) for i in some])
    for k, task in enumerate(('detect', 'recognise', 'identify')):
        say('range_p_%s_%s' % (task, name), [r['johnson_' + task] for r in table] + [r['ttp_' + task] for r in table],
            [johnson(r['cycles'] / (0.75, 3, 6)[k]) for r in table] + [ttpf(r['ttp_v'] / (2, 7.5, 13)[k]) for r in table], False)

# ---- on paper: a target without attenuation, of a sensor that resolves its pixels' half ------------------------------------
s = CURVES['staring_lwir'][0]
print('half_johnson', *('%.6g' % (2.3 / (n50 * 2 * s.ifov)) for n50 in (3, 6)))
