"""Replays of recorded walks in 3D, with K3D."""

from walkerlab.view.replay.page import Replay as Replay
from walkerlab.view.replay.page import replay as replay
