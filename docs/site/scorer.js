// What a search finds: pages to read before declarations and shown files; the rest of the scores are Sphinx's. `var`, since
// Sphinx declares it, too, where it is not.
var Scorer = {
  score: ([page, , , , score]) => (/^(reference\/cpp|files\/)/.test(page) ? score - 200 : score),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
