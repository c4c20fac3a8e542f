#!/usr/bin/env python3
"""Prints the numbers recorded in oracle.rs: the same image pairs, measured by scikit-image and flip-evaluator.

    python3 -m venv venv && venv/bin/pip install scikit-image flip-evaluator numpy && venv/bin/python oracle_pairs.py
"""
import numpy as np
import flip_evaluator
import skimage
from skimage.metrics import mean_squared_error, peak_signal_noise_ratio, structural_similarity


def grid(width, height):
    y, x, c = np.meshgrid(np.arange(height), np.arange(width), np.arange(3), indexing="ij")
    return x.astype(np.uint64), y.astype(np.uint64), c.astype(np.uint64)


def scramble(x, y, c):
    mask = np.uint64(0xFFFFFFFF)
    h = ((x * np.uint64(73856093)) ^ (y * np.uint64(19349663)) ^ (c * np.uint64(83492791))) & mask
    h ^= h >> np.uint64(13)
    h = (h * np.uint64(0x5BD1E995)) & mask
    return (h ^ (h >> np.uint64(15))).astype(np.int64)


def noise():
    x, y, c = grid(64, 48)
    a = ((x * 3 + y * 2 + c * 40) % 256).astype(np.int64)
    return a, np.clip(a + scramble(x, y, c) % 31 - 15, 0, 255)


def disc(cx, cy):
    x, y, c = (v.astype(np.int64) for v in grid(80, 60))
    inside = (x - cx) ** 2 + (y - cy) ** 2 <= 400
    return np.where(inside, np.array([220, 60, 30]), np.array([30, 40, 200]))


def blocks():
    x, y, c = grid(33, 47)
    a = scramble(x // 8, y // 8, c) % 256
    return a, a[..., ::-1]


def lines():
    x, y, _ = (v.astype(np.int64) for v in grid(61, 97))
    a = np.where((x % 13 == 0) | (y % 17 == 0), 255, 64)
    return a, np.where(x == 26, 64, a)


def radiance():
    x, y, c = grid(50, 40)
    a = ((x * y + c * 31) % 97 + 1).astype(np.float64) / 32
    h = scramble(x, y, c)
    b = a * (16 + h % 9 - 4) / 16
    return a, np.where(h % 50 == 0, -0.25, b)


def srgb(v):
    v = np.clip(v, 0, 1)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.power(np.maximum(v, 1e-12), 1 / 2.4) - 0.055)


def measure(name, a, b, linear):
    extra = {}
    if linear:
        extra = {"rmse_linear": np.sqrt(np.mean((a - b) ** 2)), "rel_mse": np.mean((a - b) ** 2 / (a * a + 1e-2))}
        a, b = srgb(a), srgb(b)
    else:
        a, b = a / 255, b / 255
    flip = flip_evaluator.evaluate(
        a.astype(np.float32), b.astype(np.float32), "LDR", inputsRGB=True, applyMagma=False)
    options = dict(gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1.0, channel_axis=2)
    values = {
        "rmse": np.sqrt(mean_squared_error(a, b)), "psnr_db": peak_signal_noise_ratio(a, b, data_range=1.0),
        "ssim": structural_similarity(a, b, **options), "flip": flip[1], **extra,
        "flip_max": flip[0].max(), "flip_at_20_20": flip[0][20, 20, 0]}
    print(name, flip[2]["ppd"], " ".join(f"{k}: {float(v):.9f}" for k, v in values.items()))


print("numpy", np.__version__, "scikit-image", skimage.__version__)
measure("noise", *noise(), False)
measure("shifted disc", disc(30, 30), disc(32, 31), False)
measure("swapped channels", *blocks(), False)
measure("missing line", *lines(), False)
measure("radiance", *radiance(), True)
