"""Signal subspaces of an array: PAST and its kin, the covariance, the stage that drives them."""
