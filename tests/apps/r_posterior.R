# Reads posterior.nc with ncdf4 and prints, for each parameter and slot, what posterior says of it:
# Rscript r_posterior.R posterior.nc      (name;slot;rhat;ess_bulk;ess_tail;mean;sd)
suppressPackageStartupMessages({library(ncdf4); library(posterior)})
file <- nc_open(commandArgs(trailingOnly = TRUE)[1])
for (name in grep("^posterior/", names(file$var), value = TRUE)) {
  # R counts dimensions from the other end: (slot,) draw, chain.
  x <- ncvar_get(file, name, collapse_degen = FALSE)
  if (length(dim(x)) == 2) dim(x) <- c(1, dim(x))
  for (slot in seq_len(dim(x)[1])) {
    draws <- x[slot, , , drop = TRUE]
    if (!all(is.finite(draws)) || length(unique(as.vector(draws))) < 2) next
    cat(sub("^posterior/", "", name), slot, sprintf("%.12g", c(rhat(draws), ess_bulk(draws), ess_tail(draws),
        mean(draws), sd(draws))), sep = ";")
    cat("\n")
  }
}
