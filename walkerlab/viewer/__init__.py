"""The replay: recorded walks in 3D, by K3D."""

from walkerlab.viewer.replay import Replay as Replay
from walkerlab.viewer.replay import replay as replay
