"""Open exercises, with more than one right answer: predict, break, and a log of one's own."""

from ._alignment import (
    break_icp,
    break_loss,
    break_sum,
    predict_scan_time,
    predict_sparse_icp,
    predict_turned_quality,
)
from ._log import (
    OwnLog,
    check_own_log,
)
from ._open import (
    Challenge,
    Prediction,
    break_quality,
    predict_beams_on_wall,
)
from ._quadtree import (
    break_cells,
    break_matching,
    predict_coarse_leaves,
)
from ._reduction import (
    break_basic_order,
    break_fusion,
    break_viewing_sector,
    predict_fusion_left,
    predict_fusion_twice,
)
from ._scans import (
    break_line,
    break_reader,
    predict_drift,
    predict_pieces,
)
