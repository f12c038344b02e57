"""From light to grey levels: exposure that follows the light, lamps that flicker with the mains, noise, gamma."""

import dataclasses

import numpy as np

GAMMA = 2.2
MAINS_HZ = 50.0


@dataclasses.dataclass
class Sensor:
    full_well: float = 6000.0   # electrons at white
    read_noise: float = 8.0     # electrons
    flicker: float = 0.0        # share of the light that goes with the mains
    auto_exposure: bool = False
    gain: float = 1.0           # where exposure is fixed; else of the first frame
    target: float = 0.2         # mean of the exposed light that auto exposure aims at
    tolerance: float = 0.35     # change of the logarithm that it lets pass


def lamp_light(t, exposure_s, share):
    """Mean light over an exposure about t [1], of lamps that go dark twice in a period of the mains."""
    w = 4 * np.pi * MAINS_HZ
    return 1 - share * np.cos(w * np.asarray(t)) * np.sinc(w * exposure_s / 2 / np.pi)


class Exposure:
    """The gain of each frame. It jumps once a frame's mean has left the tolerance, as cheap cameras do, one frame late."""

    def __init__(self, sensor):
        self.sensor, self.gain = sensor, sensor.gain

    def next(self, light):
        gain = self.gain
        if self.sensor.auto_exposure:
            mean = max(float(np.minimum(gain * light, 1).mean()), 1e-6)
            change = np.log(self.sensor.target / mean)
            if abs(change) > self.sensor.tolerance:
                self.gain = float(np.clip(gain * np.exp(change), 0.1, 30))
        return gain


def expose(light, gain, sensor, generator):
    """8-bit image of the light, 1 being the brightest that the scene has."""
    exposed = np.clip(light * gain, 0, None)
    electrons = exposed * sensor.full_well / max(gain, 1.0)  # gain above one is the amplifier's, and adds noise
    noise = np.sqrt(electrons + sensor.read_noise**2) * generator.standard_normal(light.shape)
    value = np.clip((electrons + noise) * max(gain, 1.0) / sensor.full_well, 0, 1)
    return np.uint8(np.rint(255 * value ** (1 / GAMMA)))
