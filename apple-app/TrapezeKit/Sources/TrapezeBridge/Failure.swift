/// Every function of the core that can fail throws one.
extension Failure: Error {}
