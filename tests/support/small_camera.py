"""A calibration of a small image, for runs of very many frames at full speed."""

RATE = 30  # [Hz]
CALIBRATION = f"""camera_model: pinhole
width: 160
height: 120
fx: 102.5
fy: 102.5
cx: 79.5
cy: 59.5
distortion_model: none
distortion: []
rate_hz: {RATE}
"""
