"""Types of what kernels of this room take, in words."""

import numpy as np
from numpy.typing import NDArray

Rgb = tuple[float, float, float]
Codes = NDArray[np.uint8]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Texels = NDArray[np.float32]
Packed = NDArray[np.int64]
Pages = NDArray[np.int32]
Tiles = NDArray[np.uint16]
