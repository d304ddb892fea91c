import CTrapeze

public func provoke_panic<GenericIntoRustString: IntoRustString>(_ message: GenericIntoRustString) throws -> () {
    try { let val = __swift_bridge__$provoke_panic({ let rustString = message.intoRustString(); rustString.isOwned = false; return rustString.ptr }()); if val != nil { throw Failure(ptr: val!) } else { return } }()
}
public func core_version() -> RustString {
    RustString(ptr: __swift_bridge__$core_version())
}
public func open_scene<GenericIntoRustString: IntoRustString>(_ path: GenericIntoRustString, _ work: WorkRef) throws -> Scene {
    try { let val = __swift_bridge__$open_scene({ let rustString = path.intoRustString(); rustString.isOwned = false; return rustString.ptr }(), work.ptr); if val.is_ok { return Scene(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public func open_device(_ backend: Backend, _ work: WorkRef) throws -> Device {
    try { let val = __swift_bridge__$open_device(backend.intoFfiRepr(), work.ptr); if val.is_ok { return Device(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public func make_renderer(_ device: DeviceRef, _ scene: SceneRef, _ options: RendererParameters, _ work: WorkRef) throws -> Renderer {
    try { let val = __swift_bridge__$make_renderer(device.ptr, scene.ptr, options.intoFfiRepr(), work.ptr); if val.is_ok { return Renderer(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public func open_search_model<GenericIntoRustString: IntoRustString>(_ path: GenericIntoRustString, _ work: WorkRef) throws -> SearchModel {
    try { let val = __swift_bridge__$open_search_model({ let rustString = path.intoRustString(); rustString.isOwned = false; return rustString.ptr }(), work.ptr); if val.is_ok { return SearchModel(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public func make_searcher(_ model: SearchModelRef, _ scene: SceneRef) throws -> Searcher {
    try { let val = __swift_bridge__$make_searcher(model.ptr, scene.ptr); if val.is_ok { return Searcher(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public func check_device(_ device: DeviceRef, _ work: WorkRef) throws -> SelfCheck {
    try { let val = __swift_bridge__$check_device(device.ptr, work.ptr); if val.is_ok { return SelfCheck(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public func inspect_dataset<GenericIntoRustString: IntoRustString>(_ path: GenericIntoRustString, _ downscale: UInt32, _ holdout: UInt32) throws -> Dataset {
    try { let val = __swift_bridge__$inspect_dataset({ let rustString = path.intoRustString(); rustString.isOwned = false; return rustString.ptr }(), downscale, holdout); if val.is_ok { return Dataset(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public func make_trainer<GenericIntoRustString: IntoRustString>(_ device: DeviceRef, _ dataset: DatasetRef, _ parameters: TrainParameters, _ folder: GenericIntoRustString, _ work: WorkRef) throws -> Trainer {
    try { let val = __swift_bridge__$make_trainer(device.ptr, dataset.ptr, parameters.intoFfiRepr(), { let rustString = folder.intoRustString(); rustString.isOwned = false; return rustString.ptr }(), work.ptr); if val.is_ok { return Trainer(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
}
public enum Stage {
    case Preparing
    case Reading
    case Uploading
    case Compiling
    case Encoding
    case Rendering
    case Measuring
    case Writing
}
extension Stage {
    func intoFfiRepr() -> __swift_bridge__$Stage {
        switch self {
            case Stage.Preparing:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Preparing)
            case Stage.Reading:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Reading)
            case Stage.Uploading:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Uploading)
            case Stage.Compiling:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Compiling)
            case Stage.Encoding:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Encoding)
            case Stage.Rendering:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Rendering)
            case Stage.Measuring:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Measuring)
            case Stage.Writing:
                return __swift_bridge__$Stage(tag: __swift_bridge__$Stage$Writing)
        }
    }
}
extension __swift_bridge__$Stage {
    func intoSwiftRepr() -> Stage {
        switch self.tag {
            case __swift_bridge__$Stage$Preparing:
                return Stage.Preparing
            case __swift_bridge__$Stage$Reading:
                return Stage.Reading
            case __swift_bridge__$Stage$Uploading:
                return Stage.Uploading
            case __swift_bridge__$Stage$Compiling:
                return Stage.Compiling
            case __swift_bridge__$Stage$Encoding:
                return Stage.Encoding
            case __swift_bridge__$Stage$Rendering:
                return Stage.Rendering
            case __swift_bridge__$Stage$Measuring:
                return Stage.Measuring
            case __swift_bridge__$Stage$Writing:
                return Stage.Writing
            default:
                fatalError("Unreachable")
        }
    }
}
extension __swift_bridge__$Option$Stage {
    @inline(__always)
    func intoSwiftRepr() -> Optional<Stage> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }
    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<Stage>) -> __swift_bridge__$Option$Stage {
        if let v = val {
            return __swift_bridge__$Option$Stage(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$Stage(is_some: false, val: __swift_bridge__$Stage())
        }
    }
}
extension Stage: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Stage$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Stage$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Self) {
        __swift_bridge__$Vec_Stage$push(vecPtr, value.intoFfiRepr())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Stage$pop(vecPtr)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Stage$get(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Stage$get_mut(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<Self> {
        UnsafePointer<Self>(OpaquePointer(__swift_bridge__$Vec_Stage$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Stage$len(vecPtr)
    }
}
public enum FrameMode {
    case Color
    case Clusters
    case Depth
    case Motion
}
extension FrameMode {
    func intoFfiRepr() -> __swift_bridge__$FrameMode {
        switch self {
            case FrameMode.Color:
                return __swift_bridge__$FrameMode(tag: __swift_bridge__$FrameMode$Color)
            case FrameMode.Clusters:
                return __swift_bridge__$FrameMode(tag: __swift_bridge__$FrameMode$Clusters)
            case FrameMode.Depth:
                return __swift_bridge__$FrameMode(tag: __swift_bridge__$FrameMode$Depth)
            case FrameMode.Motion:
                return __swift_bridge__$FrameMode(tag: __swift_bridge__$FrameMode$Motion)
        }
    }
}
extension __swift_bridge__$FrameMode {
    func intoSwiftRepr() -> FrameMode {
        switch self.tag {
            case __swift_bridge__$FrameMode$Color:
                return FrameMode.Color
            case __swift_bridge__$FrameMode$Clusters:
                return FrameMode.Clusters
            case __swift_bridge__$FrameMode$Depth:
                return FrameMode.Depth
            case __swift_bridge__$FrameMode$Motion:
                return FrameMode.Motion
            default:
                fatalError("Unreachable")
        }
    }
}
extension __swift_bridge__$Option$FrameMode {
    @inline(__always)
    func intoSwiftRepr() -> Optional<FrameMode> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }
    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<FrameMode>) -> __swift_bridge__$Option$FrameMode {
        if let v = val {
            return __swift_bridge__$Option$FrameMode(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$FrameMode(is_some: false, val: __swift_bridge__$FrameMode())
        }
    }
}
extension FrameMode: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_FrameMode$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_FrameMode$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Self) {
        __swift_bridge__$Vec_FrameMode$push(vecPtr, value.intoFfiRepr())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_FrameMode$pop(vecPtr)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_FrameMode$get(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_FrameMode$get_mut(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<Self> {
        UnsafePointer<Self>(OpaquePointer(__swift_bridge__$Vec_FrameMode$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_FrameMode$len(vecPtr)
    }
}
public enum Visibility {
    case All
    case Isolate
    case Hide
}
extension Visibility {
    func intoFfiRepr() -> __swift_bridge__$Visibility {
        switch self {
            case Visibility.All:
                return __swift_bridge__$Visibility(tag: __swift_bridge__$Visibility$All)
            case Visibility.Isolate:
                return __swift_bridge__$Visibility(tag: __swift_bridge__$Visibility$Isolate)
            case Visibility.Hide:
                return __swift_bridge__$Visibility(tag: __swift_bridge__$Visibility$Hide)
        }
    }
}
extension __swift_bridge__$Visibility {
    func intoSwiftRepr() -> Visibility {
        switch self.tag {
            case __swift_bridge__$Visibility$All:
                return Visibility.All
            case __swift_bridge__$Visibility$Isolate:
                return Visibility.Isolate
            case __swift_bridge__$Visibility$Hide:
                return Visibility.Hide
            default:
                fatalError("Unreachable")
        }
    }
}
extension __swift_bridge__$Option$Visibility {
    @inline(__always)
    func intoSwiftRepr() -> Optional<Visibility> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }
    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<Visibility>) -> __swift_bridge__$Option$Visibility {
        if let v = val {
            return __swift_bridge__$Option$Visibility(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$Visibility(is_some: false, val: __swift_bridge__$Visibility())
        }
    }
}
extension Visibility: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Visibility$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Visibility$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Self) {
        __swift_bridge__$Vec_Visibility$push(vecPtr, value.intoFfiRepr())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Visibility$pop(vecPtr)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Visibility$get(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Visibility$get_mut(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<Self> {
        UnsafePointer<Self>(OpaquePointer(__swift_bridge__$Vec_Visibility$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Visibility$len(vecPtr)
    }
}
public enum ExportFormat {
    case Ply
    case Spz
    case Folder
}
extension ExportFormat {
    func intoFfiRepr() -> __swift_bridge__$ExportFormat {
        switch self {
            case ExportFormat.Ply:
                return __swift_bridge__$ExportFormat(tag: __swift_bridge__$ExportFormat$Ply)
            case ExportFormat.Spz:
                return __swift_bridge__$ExportFormat(tag: __swift_bridge__$ExportFormat$Spz)
            case ExportFormat.Folder:
                return __swift_bridge__$ExportFormat(tag: __swift_bridge__$ExportFormat$Folder)
        }
    }
}
extension __swift_bridge__$ExportFormat {
    func intoSwiftRepr() -> ExportFormat {
        switch self.tag {
            case __swift_bridge__$ExportFormat$Ply:
                return ExportFormat.Ply
            case __swift_bridge__$ExportFormat$Spz:
                return ExportFormat.Spz
            case __swift_bridge__$ExportFormat$Folder:
                return ExportFormat.Folder
            default:
                fatalError("Unreachable")
        }
    }
}
extension __swift_bridge__$Option$ExportFormat {
    @inline(__always)
    func intoSwiftRepr() -> Optional<ExportFormat> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }
    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<ExportFormat>) -> __swift_bridge__$Option$ExportFormat {
        if let v = val {
            return __swift_bridge__$Option$ExportFormat(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$ExportFormat(is_some: false, val: __swift_bridge__$ExportFormat())
        }
    }
}
extension ExportFormat: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_ExportFormat$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_ExportFormat$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Self) {
        __swift_bridge__$Vec_ExportFormat$push(vecPtr, value.intoFfiRepr())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_ExportFormat$pop(vecPtr)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_ExportFormat$get(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_ExportFormat$get_mut(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<Self> {
        UnsafePointer<Self>(OpaquePointer(__swift_bridge__$Vec_ExportFormat$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_ExportFormat$len(vecPtr)
    }
}
public enum Backend {
    case Automatic
    case Gpu
    case Cpu
}
extension Backend {
    func intoFfiRepr() -> __swift_bridge__$Backend {
        switch self {
            case Backend.Automatic:
                return __swift_bridge__$Backend(tag: __swift_bridge__$Backend$Automatic)
            case Backend.Gpu:
                return __swift_bridge__$Backend(tag: __swift_bridge__$Backend$Gpu)
            case Backend.Cpu:
                return __swift_bridge__$Backend(tag: __swift_bridge__$Backend$Cpu)
        }
    }
}
extension __swift_bridge__$Backend {
    func intoSwiftRepr() -> Backend {
        switch self.tag {
            case __swift_bridge__$Backend$Automatic:
                return Backend.Automatic
            case __swift_bridge__$Backend$Gpu:
                return Backend.Gpu
            case __swift_bridge__$Backend$Cpu:
                return Backend.Cpu
            default:
                fatalError("Unreachable")
        }
    }
}
extension __swift_bridge__$Option$Backend {
    @inline(__always)
    func intoSwiftRepr() -> Optional<Backend> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }
    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<Backend>) -> __swift_bridge__$Option$Backend {
        if let v = val {
            return __swift_bridge__$Option$Backend(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$Backend(is_some: false, val: __swift_bridge__$Backend())
        }
    }
}
extension Backend: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Backend$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Backend$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Self) {
        __swift_bridge__$Vec_Backend$push(vecPtr, value.intoFfiRepr())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Backend$pop(vecPtr)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Backend$get(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_Backend$get_mut(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<Self> {
        UnsafePointer<Self>(OpaquePointer(__swift_bridge__$Vec_Backend$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Backend$len(vecPtr)
    }
}
public enum TrainEventKind {
    case Report
    case Saved
    case RolledBack
}
extension TrainEventKind {
    func intoFfiRepr() -> __swift_bridge__$TrainEventKind {
        switch self {
            case TrainEventKind.Report:
                return __swift_bridge__$TrainEventKind(tag: __swift_bridge__$TrainEventKind$Report)
            case TrainEventKind.Saved:
                return __swift_bridge__$TrainEventKind(tag: __swift_bridge__$TrainEventKind$Saved)
            case TrainEventKind.RolledBack:
                return __swift_bridge__$TrainEventKind(tag: __swift_bridge__$TrainEventKind$RolledBack)
        }
    }
}
extension __swift_bridge__$TrainEventKind {
    func intoSwiftRepr() -> TrainEventKind {
        switch self.tag {
            case __swift_bridge__$TrainEventKind$Report:
                return TrainEventKind.Report
            case __swift_bridge__$TrainEventKind$Saved:
                return TrainEventKind.Saved
            case __swift_bridge__$TrainEventKind$RolledBack:
                return TrainEventKind.RolledBack
            default:
                fatalError("Unreachable")
        }
    }
}
extension __swift_bridge__$Option$TrainEventKind {
    @inline(__always)
    func intoSwiftRepr() -> Optional<TrainEventKind> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }
    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<TrainEventKind>) -> __swift_bridge__$Option$TrainEventKind {
        if let v = val {
            return __swift_bridge__$Option$TrainEventKind(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$TrainEventKind(is_some: false, val: __swift_bridge__$TrainEventKind())
        }
    }
}
extension TrainEventKind: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_TrainEventKind$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_TrainEventKind$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Self) {
        __swift_bridge__$Vec_TrainEventKind$push(vecPtr, value.intoFfiRepr())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_TrainEventKind$pop(vecPtr)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_TrainEventKind$get(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<Self> {
        let maybeEnum = __swift_bridge__$Vec_TrainEventKind$get_mut(vecPtr, index)
        return maybeEnum.intoSwiftRepr()
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<Self> {
        UnsafePointer<Self>(OpaquePointer(__swift_bridge__$Vec_TrainEventKind$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_TrainEventKind$len(vecPtr)
    }
}
public struct WorkProgress {
    public var stage: Stage
    public var fraction: Double

    public init(stage: Stage,fraction: Double) {
        self.stage = stage
        self.fraction = fraction
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$WorkProgress {
        { let val = self; return __swift_bridge__$WorkProgress(stage: val.stage.intoFfiRepr(), fraction: val.fraction); }()
    }
}
extension __swift_bridge__$WorkProgress {
    @inline(__always)
    func intoSwiftRepr() -> WorkProgress {
        { let val = self; return WorkProgress(stage: val.stage.intoSwiftRepr(), fraction: val.fraction); }()
    }
}
extension __swift_bridge__$Option$WorkProgress {
    @inline(__always)
    func intoSwiftRepr() -> Optional<WorkProgress> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<WorkProgress>) -> __swift_bridge__$Option$WorkProgress {
        if let v = val {
            return __swift_bridge__$Option$WorkProgress(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$WorkProgress(is_some: false, val: __swift_bridge__$WorkProgress())
        }
    }
}
public struct Box3 {
    public var min_x: Double
    public var min_y: Double
    public var min_z: Double
    public var max_x: Double
    public var max_y: Double
    public var max_z: Double

    public init(min_x: Double,min_y: Double,min_z: Double,max_x: Double,max_y: Double,max_z: Double) {
        self.min_x = min_x
        self.min_y = min_y
        self.min_z = min_z
        self.max_x = max_x
        self.max_y = max_y
        self.max_z = max_z
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$Box3 {
        { let val = self; return __swift_bridge__$Box3(min_x: val.min_x, min_y: val.min_y, min_z: val.min_z, max_x: val.max_x, max_y: val.max_y, max_z: val.max_z); }()
    }
}
extension __swift_bridge__$Box3 {
    @inline(__always)
    func intoSwiftRepr() -> Box3 {
        { let val = self; return Box3(min_x: val.min_x, min_y: val.min_y, min_z: val.min_z, max_x: val.max_x, max_y: val.max_y, max_z: val.max_z); }()
    }
}
extension __swift_bridge__$Option$Box3 {
    @inline(__always)
    func intoSwiftRepr() -> Optional<Box3> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<Box3>) -> __swift_bridge__$Option$Box3 {
        if let v = val {
            return __swift_bridge__$Option$Box3(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$Box3(is_some: false, val: __swift_bridge__$Box3())
        }
    }
}
public struct SceneFigures {
    public var splats: UInt64
    public var harmonics_degree: UInt32
    public var framing: Box3
    public var deformable: Bool
    public var has_motion: Bool
    public var recommended_percentile: Double
    public var memory_bytes: UInt64
    public var clusters: UInt

    public init(splats: UInt64,harmonics_degree: UInt32,framing: Box3,deformable: Bool,has_motion: Bool,recommended_percentile: Double,memory_bytes: UInt64,clusters: UInt) {
        self.splats = splats
        self.harmonics_degree = harmonics_degree
        self.framing = framing
        self.deformable = deformable
        self.has_motion = has_motion
        self.recommended_percentile = recommended_percentile
        self.memory_bytes = memory_bytes
        self.clusters = clusters
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$SceneFigures {
        { let val = self; return __swift_bridge__$SceneFigures(splats: val.splats, harmonics_degree: val.harmonics_degree, framing: val.framing.intoFfiRepr(), deformable: val.deformable, has_motion: val.has_motion, recommended_percentile: val.recommended_percentile, memory_bytes: val.memory_bytes, clusters: val.clusters); }()
    }
}
extension __swift_bridge__$SceneFigures {
    @inline(__always)
    func intoSwiftRepr() -> SceneFigures {
        { let val = self; return SceneFigures(splats: val.splats, harmonics_degree: val.harmonics_degree, framing: val.framing.intoSwiftRepr(), deformable: val.deformable, has_motion: val.has_motion, recommended_percentile: val.recommended_percentile, memory_bytes: val.memory_bytes, clusters: val.clusters); }()
    }
}
extension __swift_bridge__$Option$SceneFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<SceneFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<SceneFigures>) -> __swift_bridge__$Option$SceneFigures {
        if let v = val {
            return __swift_bridge__$Option$SceneFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$SceneFigures(is_some: false, val: __swift_bridge__$SceneFigures())
        }
    }
}
public struct ClusterFigures {
    public var id: UInt32
    public var red: Float
    public var green: Float
    public var blue: Float
    public var splats: UInt64

    public init(id: UInt32,red: Float,green: Float,blue: Float,splats: UInt64) {
        self.id = id
        self.red = red
        self.green = green
        self.blue = blue
        self.splats = splats
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$ClusterFigures {
        { let val = self; return __swift_bridge__$ClusterFigures(id: val.id, red: val.red, green: val.green, blue: val.blue, splats: val.splats); }()
    }
}
extension __swift_bridge__$ClusterFigures {
    @inline(__always)
    func intoSwiftRepr() -> ClusterFigures {
        { let val = self; return ClusterFigures(id: val.id, red: val.red, green: val.green, blue: val.blue, splats: val.splats); }()
    }
}
extension __swift_bridge__$Option$ClusterFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<ClusterFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<ClusterFigures>) -> __swift_bridge__$Option$ClusterFigures {
        if let v = val {
            return __swift_bridge__$Option$ClusterFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$ClusterFigures(is_some: false, val: __swift_bridge__$ClusterFigures())
        }
    }
}
public struct Lens {
    public var width: UInt32
    public var height: UInt32
    public var fx: Double
    public var fy: Double
    public var cx: Double
    public var cy: Double

    public init(width: UInt32,height: UInt32,fx: Double,fy: Double,cx: Double,cy: Double) {
        self.width = width
        self.height = height
        self.fx = fx
        self.fy = fy
        self.cx = cx
        self.cy = cy
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$Lens {
        { let val = self; return __swift_bridge__$Lens(width: val.width, height: val.height, fx: val.fx, fy: val.fy, cx: val.cx, cy: val.cy); }()
    }
}
extension __swift_bridge__$Lens {
    @inline(__always)
    func intoSwiftRepr() -> Lens {
        { let val = self; return Lens(width: val.width, height: val.height, fx: val.fx, fy: val.fy, cx: val.cx, cy: val.cy); }()
    }
}
extension __swift_bridge__$Option$Lens {
    @inline(__always)
    func intoSwiftRepr() -> Optional<Lens> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<Lens>) -> __swift_bridge__$Option$Lens {
        if let v = val {
            return __swift_bridge__$Option$Lens(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$Lens(is_some: false, val: __swift_bridge__$Lens())
        }
    }
}
public struct FrameParameters {
    public var lens: Lens
    public var time: Double
    public var mode: FrameMode
    public var visibility: Visibility
    public var static_threshold: Float
    public var background_red: Float
    public var background_green: Float
    public var background_blue: Float

    public init(lens: Lens,time: Double,mode: FrameMode,visibility: Visibility,static_threshold: Float,background_red: Float,background_green: Float,background_blue: Float) {
        self.lens = lens
        self.time = time
        self.mode = mode
        self.visibility = visibility
        self.static_threshold = static_threshold
        self.background_red = background_red
        self.background_green = background_green
        self.background_blue = background_blue
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$FrameParameters {
        { let val = self; return __swift_bridge__$FrameParameters(lens: val.lens.intoFfiRepr(), time: val.time, mode: val.mode.intoFfiRepr(), visibility: val.visibility.intoFfiRepr(), static_threshold: val.static_threshold, background_red: val.background_red, background_green: val.background_green, background_blue: val.background_blue); }()
    }
}
extension __swift_bridge__$FrameParameters {
    @inline(__always)
    func intoSwiftRepr() -> FrameParameters {
        { let val = self; return FrameParameters(lens: val.lens.intoSwiftRepr(), time: val.time, mode: val.mode.intoSwiftRepr(), visibility: val.visibility.intoSwiftRepr(), static_threshold: val.static_threshold, background_red: val.background_red, background_green: val.background_green, background_blue: val.background_blue); }()
    }
}
extension __swift_bridge__$Option$FrameParameters {
    @inline(__always)
    func intoSwiftRepr() -> Optional<FrameParameters> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<FrameParameters>) -> __swift_bridge__$Option$FrameParameters {
        if let v = val {
            return __swift_bridge__$Option$FrameParameters(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$FrameParameters(is_some: false, val: __swift_bridge__$FrameParameters())
        }
    }
}
public struct RendererParameters {
    public var half_precision: Bool
    public var max_harmonics_degree: UInt32

    public init(half_precision: Bool,max_harmonics_degree: UInt32) {
        self.half_precision = half_precision
        self.max_harmonics_degree = max_harmonics_degree
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$RendererParameters {
        { let val = self; return __swift_bridge__$RendererParameters(half_precision: val.half_precision, max_harmonics_degree: val.max_harmonics_degree); }()
    }
}
extension __swift_bridge__$RendererParameters {
    @inline(__always)
    func intoSwiftRepr() -> RendererParameters {
        { let val = self; return RendererParameters(half_precision: val.half_precision, max_harmonics_degree: val.max_harmonics_degree); }()
    }
}
extension __swift_bridge__$Option$RendererParameters {
    @inline(__always)
    func intoSwiftRepr() -> Optional<RendererParameters> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<RendererParameters>) -> __swift_bridge__$Option$RendererParameters {
        if let v = val {
            return __swift_bridge__$Option$RendererParameters(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$RendererParameters(is_some: false, val: __swift_bridge__$RendererParameters())
        }
    }
}
public struct DrawFigures {
    public var needs_redraw: Bool
    public var frame_seconds: Double
    public var deform_seconds: Double
    public var sort_seconds: Double
    public var rasterize_seconds: Double
    public var deformed_splats: UInt64
    public var visible_splats: UInt64
    public var total_splats: UInt64
    public var device_bytes: UInt64

    public init(needs_redraw: Bool,frame_seconds: Double,deform_seconds: Double,sort_seconds: Double,rasterize_seconds: Double,deformed_splats: UInt64,visible_splats: UInt64,total_splats: UInt64,device_bytes: UInt64) {
        self.needs_redraw = needs_redraw
        self.frame_seconds = frame_seconds
        self.deform_seconds = deform_seconds
        self.sort_seconds = sort_seconds
        self.rasterize_seconds = rasterize_seconds
        self.deformed_splats = deformed_splats
        self.visible_splats = visible_splats
        self.total_splats = total_splats
        self.device_bytes = device_bytes
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$DrawFigures {
        { let val = self; return __swift_bridge__$DrawFigures(needs_redraw: val.needs_redraw, frame_seconds: val.frame_seconds, deform_seconds: val.deform_seconds, sort_seconds: val.sort_seconds, rasterize_seconds: val.rasterize_seconds, deformed_splats: val.deformed_splats, visible_splats: val.visible_splats, total_splats: val.total_splats, device_bytes: val.device_bytes); }()
    }
}
extension __swift_bridge__$DrawFigures {
    @inline(__always)
    func intoSwiftRepr() -> DrawFigures {
        { let val = self; return DrawFigures(needs_redraw: val.needs_redraw, frame_seconds: val.frame_seconds, deform_seconds: val.deform_seconds, sort_seconds: val.sort_seconds, rasterize_seconds: val.rasterize_seconds, deformed_splats: val.deformed_splats, visible_splats: val.visible_splats, total_splats: val.total_splats, device_bytes: val.device_bytes); }()
    }
}
extension __swift_bridge__$Option$DrawFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<DrawFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<DrawFigures>) -> __swift_bridge__$Option$DrawFigures {
        if let v = val {
            return __swift_bridge__$Option$DrawFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$DrawFigures(is_some: false, val: __swift_bridge__$DrawFigures())
        }
    }
}
public struct PickFigures {
    public var is_hit: Bool
    public var splat: UInt32
    public var has_cluster: Bool
    public var cluster: UInt32
    public var depth: Double

    public init(is_hit: Bool,splat: UInt32,has_cluster: Bool,cluster: UInt32,depth: Double) {
        self.is_hit = is_hit
        self.splat = splat
        self.has_cluster = has_cluster
        self.cluster = cluster
        self.depth = depth
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$PickFigures {
        { let val = self; return __swift_bridge__$PickFigures(is_hit: val.is_hit, splat: val.splat, has_cluster: val.has_cluster, cluster: val.cluster, depth: val.depth); }()
    }
}
extension __swift_bridge__$PickFigures {
    @inline(__always)
    func intoSwiftRepr() -> PickFigures {
        { let val = self; return PickFigures(is_hit: val.is_hit, splat: val.splat, has_cluster: val.has_cluster, cluster: val.cluster, depth: val.depth); }()
    }
}
extension __swift_bridge__$Option$PickFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<PickFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<PickFigures>) -> __swift_bridge__$Option$PickFigures {
        if let v = val {
            return __swift_bridge__$Option$PickFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$PickFigures(is_some: false, val: __swift_bridge__$PickFigures())
        }
    }
}
public struct MeasurementFigures {
    public var frame_milliseconds: Double
    public var psnr: Double

    public init(frame_milliseconds: Double,psnr: Double) {
        self.frame_milliseconds = frame_milliseconds
        self.psnr = psnr
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$MeasurementFigures {
        { let val = self; return __swift_bridge__$MeasurementFigures(frame_milliseconds: val.frame_milliseconds, psnr: val.psnr); }()
    }
}
extension __swift_bridge__$MeasurementFigures {
    @inline(__always)
    func intoSwiftRepr() -> MeasurementFigures {
        { let val = self; return MeasurementFigures(frame_milliseconds: val.frame_milliseconds, psnr: val.psnr); }()
    }
}
extension __swift_bridge__$Option$MeasurementFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<MeasurementFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<MeasurementFigures>) -> __swift_bridge__$Option$MeasurementFigures {
        if let v = val {
            return __swift_bridge__$Option$MeasurementFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$MeasurementFigures(is_some: false, val: __swift_bridge__$MeasurementFigures())
        }
    }
}
public struct HitFigures {
    public var cluster: UInt32
    public var score: Double

    public init(cluster: UInt32,score: Double) {
        self.cluster = cluster
        self.score = score
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$HitFigures {
        { let val = self; return __swift_bridge__$HitFigures(cluster: val.cluster, score: val.score); }()
    }
}
extension __swift_bridge__$HitFigures {
    @inline(__always)
    func intoSwiftRepr() -> HitFigures {
        { let val = self; return HitFigures(cluster: val.cluster, score: val.score); }()
    }
}
extension __swift_bridge__$Option$HitFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<HitFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<HitFigures>) -> __swift_bridge__$Option$HitFigures {
        if let v = val {
            return __swift_bridge__$Option$HitFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$HitFigures(is_some: false, val: __swift_bridge__$HitFigures())
        }
    }
}
public struct CheckFigures {
    public var psnr: Double
    public var milliseconds: Double
    public var passed: Bool

    public init(psnr: Double,milliseconds: Double,passed: Bool) {
        self.psnr = psnr
        self.milliseconds = milliseconds
        self.passed = passed
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$CheckFigures {
        { let val = self; return __swift_bridge__$CheckFigures(psnr: val.psnr, milliseconds: val.milliseconds, passed: val.passed); }()
    }
}
extension __swift_bridge__$CheckFigures {
    @inline(__always)
    func intoSwiftRepr() -> CheckFigures {
        { let val = self; return CheckFigures(psnr: val.psnr, milliseconds: val.milliseconds, passed: val.passed); }()
    }
}
extension __swift_bridge__$Option$CheckFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<CheckFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<CheckFigures>) -> __swift_bridge__$Option$CheckFigures {
        if let v = val {
            return __swift_bridge__$Option$CheckFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$CheckFigures(is_some: false, val: __swift_bridge__$CheckFigures())
        }
    }
}
public struct DatasetFigures {
    public var views: UInt
    public var width: UInt32
    public var height: UInt32
    public var points: UInt64

    public init(views: UInt,width: UInt32,height: UInt32,points: UInt64) {
        self.views = views
        self.width = width
        self.height = height
        self.points = points
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$DatasetFigures {
        { let val = self; return __swift_bridge__$DatasetFigures(views: val.views, width: val.width, height: val.height, points: val.points); }()
    }
}
extension __swift_bridge__$DatasetFigures {
    @inline(__always)
    func intoSwiftRepr() -> DatasetFigures {
        { let val = self; return DatasetFigures(views: val.views, width: val.width, height: val.height, points: val.points); }()
    }
}
extension __swift_bridge__$Option$DatasetFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<DatasetFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<DatasetFigures>) -> __swift_bridge__$Option$DatasetFigures {
        if let v = val {
            return __swift_bridge__$Option$DatasetFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$DatasetFigures(is_some: false, val: __swift_bridge__$DatasetFigures())
        }
    }
}
public struct TrainParameters {
    public var steps: UInt32
    public var max_splats: UInt32
    public var harmonics_degree: UInt32
    public var memory_limit: UInt64
    public var backend: Backend

    public init(steps: UInt32,max_splats: UInt32,harmonics_degree: UInt32,memory_limit: UInt64,backend: Backend) {
        self.steps = steps
        self.max_splats = max_splats
        self.harmonics_degree = harmonics_degree
        self.memory_limit = memory_limit
        self.backend = backend
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$TrainParameters {
        { let val = self; return __swift_bridge__$TrainParameters(steps: val.steps, max_splats: val.max_splats, harmonics_degree: val.harmonics_degree, memory_limit: val.memory_limit, backend: val.backend.intoFfiRepr()); }()
    }
}
extension __swift_bridge__$TrainParameters {
    @inline(__always)
    func intoSwiftRepr() -> TrainParameters {
        { let val = self; return TrainParameters(steps: val.steps, max_splats: val.max_splats, harmonics_degree: val.harmonics_degree, memory_limit: val.memory_limit, backend: val.backend.intoSwiftRepr()); }()
    }
}
extension __swift_bridge__$Option$TrainParameters {
    @inline(__always)
    func intoSwiftRepr() -> Optional<TrainParameters> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<TrainParameters>) -> __swift_bridge__$Option$TrainParameters {
        if let v = val {
            return __swift_bridge__$Option$TrainParameters(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$TrainParameters(is_some: false, val: __swift_bridge__$TrainParameters())
        }
    }
}
public struct TrainFigures {
    public var step: UInt32
    public var steps: UInt32
    public var seconds: Double
    public var steps_per_second: Double
    public var loss: Double
    public var psnr: Double
    public var splats: UInt32

    public init(step: UInt32,steps: UInt32,seconds: Double,steps_per_second: Double,loss: Double,psnr: Double,splats: UInt32) {
        self.step = step
        self.steps = steps
        self.seconds = seconds
        self.steps_per_second = steps_per_second
        self.loss = loss
        self.psnr = psnr
        self.splats = splats
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$TrainFigures {
        { let val = self; return __swift_bridge__$TrainFigures(step: val.step, steps: val.steps, seconds: val.seconds, steps_per_second: val.steps_per_second, loss: val.loss, psnr: val.psnr, splats: val.splats); }()
    }
}
extension __swift_bridge__$TrainFigures {
    @inline(__always)
    func intoSwiftRepr() -> TrainFigures {
        { let val = self; return TrainFigures(step: val.step, steps: val.steps, seconds: val.seconds, steps_per_second: val.steps_per_second, loss: val.loss, psnr: val.psnr, splats: val.splats); }()
    }
}
extension __swift_bridge__$Option$TrainFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<TrainFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<TrainFigures>) -> __swift_bridge__$Option$TrainFigures {
        if let v = val {
            return __swift_bridge__$Option$TrainFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$TrainFigures(is_some: false, val: __swift_bridge__$TrainFigures())
        }
    }
}
public struct TrainEventFigures {
    public var is_event: Bool
    public var kind: TrainEventKind
    public var report: TrainFigures
    public var step: UInt32
    public var to: UInt32

    public init(is_event: Bool,kind: TrainEventKind,report: TrainFigures,step: UInt32,to: UInt32) {
        self.is_event = is_event
        self.kind = kind
        self.report = report
        self.step = step
        self.to = to
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$TrainEventFigures {
        { let val = self; return __swift_bridge__$TrainEventFigures(is_event: val.is_event, kind: val.kind.intoFfiRepr(), report: val.report.intoFfiRepr(), step: val.step, to: val.to); }()
    }
}
extension __swift_bridge__$TrainEventFigures {
    @inline(__always)
    func intoSwiftRepr() -> TrainEventFigures {
        { let val = self; return TrainEventFigures(is_event: val.is_event, kind: val.kind.intoSwiftRepr(), report: val.report.intoSwiftRepr(), step: val.step, to: val.to); }()
    }
}
extension __swift_bridge__$Option$TrainEventFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<TrainEventFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<TrainEventFigures>) -> __swift_bridge__$Option$TrainEventFigures {
        if let v = val {
            return __swift_bridge__$Option$TrainEventFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$TrainEventFigures(is_some: false, val: __swift_bridge__$TrainEventFigures())
        }
    }
}
public struct TestFigures {
    public var psnr: Double
    public var ssim: Double

    public init(psnr: Double,ssim: Double) {
        self.psnr = psnr
        self.ssim = ssim
    }

    @inline(__always)
    func intoFfiRepr() -> __swift_bridge__$TestFigures {
        { let val = self; return __swift_bridge__$TestFigures(psnr: val.psnr, ssim: val.ssim); }()
    }
}
extension __swift_bridge__$TestFigures {
    @inline(__always)
    func intoSwiftRepr() -> TestFigures {
        { let val = self; return TestFigures(psnr: val.psnr, ssim: val.ssim); }()
    }
}
extension __swift_bridge__$Option$TestFigures {
    @inline(__always)
    func intoSwiftRepr() -> Optional<TestFigures> {
        if self.is_some {
            return self.val.intoSwiftRepr()
        } else {
            return nil
        }
    }

    @inline(__always)
    static func fromSwiftRepr(_ val: Optional<TestFigures>) -> __swift_bridge__$Option$TestFigures {
        if let v = val {
            return __swift_bridge__$Option$TestFigures(is_some: true, val: v.intoFfiRepr())
        } else {
            return __swift_bridge__$Option$TestFigures(is_some: false, val: __swift_bridge__$TestFigures())
        }
    }
}

public class Failure: FailureRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Failure$_free(ptr)
        }
    }
}
public class FailureRefMut: FailureRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class FailureRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension FailureRef {
    public func code() -> Int32 {
        __swift_bridge__$Failure$code(ptr)
    }

    public func message() -> RustString {
        RustString(ptr: __swift_bridge__$Failure$message(ptr))
    }
}
extension Failure: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Failure$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Failure$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Failure) {
        __swift_bridge__$Vec_Failure$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Failure$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Failure(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<FailureRef> {
        let pointer = __swift_bridge__$Vec_Failure$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return FailureRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<FailureRefMut> {
        let pointer = __swift_bridge__$Vec_Failure$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return FailureRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<FailureRef> {
        UnsafePointer<FailureRef>(OpaquePointer(__swift_bridge__$Vec_Failure$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Failure$len(vecPtr)
    }
}

extension Failure: @unchecked Sendable {}
public class Work: WorkRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Work$_free(ptr)
        }
    }
}
extension Work {
    public convenience init() {
        self.init(ptr: __swift_bridge__$Work$new())
    }
}
public class WorkRefMut: WorkRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class WorkRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension WorkRef {
    public func cancel() {
        __swift_bridge__$Work$cancel(ptr)
    }

    public func progress() -> WorkProgress {
        __swift_bridge__$Work$progress(ptr).intoSwiftRepr()
    }
}
extension Work: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Work$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Work$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Work) {
        __swift_bridge__$Vec_Work$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Work$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Work(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<WorkRef> {
        let pointer = __swift_bridge__$Vec_Work$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return WorkRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<WorkRefMut> {
        let pointer = __swift_bridge__$Vec_Work$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return WorkRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<WorkRef> {
        UnsafePointer<WorkRef>(OpaquePointer(__swift_bridge__$Vec_Work$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Work$len(vecPtr)
    }
}

extension Work: @unchecked Sendable {}
public class Image: ImageRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Image$_free(ptr)
        }
    }
}
public class ImageRefMut: ImageRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class ImageRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension ImageRef {
    public func width() -> UInt32 {
        __swift_bridge__$Image$width(ptr)
    }

    public func height() -> UInt32 {
        __swift_bridge__$Image$height(ptr)
    }

    public func bytes() -> UnsafePointer<UInt8> {
        __swift_bridge__$Image$bytes(ptr)
    }

    public func byte_count() -> UInt {
        __swift_bridge__$Image$byte_count(ptr)
    }
}
extension Image: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Image$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Image$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Image) {
        __swift_bridge__$Vec_Image$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Image$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Image(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<ImageRef> {
        let pointer = __swift_bridge__$Vec_Image$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return ImageRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<ImageRefMut> {
        let pointer = __swift_bridge__$Vec_Image$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return ImageRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<ImageRef> {
        UnsafePointer<ImageRef>(OpaquePointer(__swift_bridge__$Vec_Image$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Image$len(vecPtr)
    }
}

extension Image: @unchecked Sendable {}
public class Scene: SceneRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Scene$_free(ptr)
        }
    }
}
public class SceneRefMut: SceneRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class SceneRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension SceneRef {
    public func figures() -> SceneFigures {
        __swift_bridge__$Scene$figures(ptr).intoSwiftRepr()
    }

    public func warnings() -> RustVec<RustString> {
        RustVec(ptr: __swift_bridge__$Scene$warnings(ptr))
    }

    public func cluster(_ index: UInt) -> ClusterFigures {
        __swift_bridge__$Scene$cluster(ptr, index).intoSwiftRepr()
    }

    public func cluster_name(_ index: UInt) -> Optional<RustString> {
        { let val = __swift_bridge__$Scene$cluster_name(ptr, index); if val != nil { return RustString(ptr: val!) } else { return nil } }()
    }

    public func static_threshold(_ percentile: Double) -> Float {
        __swift_bridge__$Scene$static_threshold(ptr, percentile)
    }

    public func cluster_bounds(_ cluster: UInt32, _ time: Double) throws -> Box3 {
        try { let val = __swift_bridge__$Scene$cluster_bounds(ptr, cluster, time); switch val.tag { case __swift_bridge__$ResultBox3AndFailure$ResultOk: return val.payload.ok.intoSwiftRepr() case __swift_bridge__$ResultBox3AndFailure$ResultErr: throw Failure(ptr: val.payload.err) default: fatalError() } }()
    }

    public func edited(_ edits: EditsRef, _ work: WorkRef) throws -> Scene {
        try { let val = __swift_bridge__$Scene$edited(ptr, edits.ptr, work.ptr); if val.is_ok { return Scene(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }

    public func with_motion(_ work: WorkRef) throws -> Scene {
        try { let val = __swift_bridge__$Scene$with_motion(ptr, work.ptr); if val.is_ok { return Scene(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }

    public func export_to<GenericIntoRustString: IntoRustString>(_ path: GenericIntoRustString, _ format: ExportFormat, _ work: WorkRef) throws -> Exported {
        try { let val = __swift_bridge__$Scene$export_to(ptr, { let rustString = path.intoRustString(); rustString.isOwned = false; return rustString.ptr }(), format.intoFfiRepr(), work.ptr); if val.is_ok { return Exported(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }
}
extension Scene: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Scene$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Scene$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Scene) {
        __swift_bridge__$Vec_Scene$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Scene$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Scene(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SceneRef> {
        let pointer = __swift_bridge__$Vec_Scene$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SceneRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SceneRefMut> {
        let pointer = __swift_bridge__$Vec_Scene$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SceneRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<SceneRef> {
        UnsafePointer<SceneRef>(OpaquePointer(__swift_bridge__$Vec_Scene$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Scene$len(vecPtr)
    }
}

extension Scene: @unchecked Sendable {}
public class Exported: ExportedRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Exported$_free(ptr)
        }
    }
}
public class ExportedRefMut: ExportedRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class ExportedRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension ExportedRef {
    public func splat_count() -> UInt64 {
        __swift_bridge__$Exported$splat_count(ptr)
    }

    public func file_bytes() -> UInt64 {
        __swift_bridge__$Exported$file_bytes(ptr)
    }

    public func warnings() -> RustVec<RustString> {
        RustVec(ptr: __swift_bridge__$Exported$warnings(ptr))
    }
}
extension Exported: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Exported$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Exported$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Exported) {
        __swift_bridge__$Vec_Exported$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Exported$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Exported(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<ExportedRef> {
        let pointer = __swift_bridge__$Vec_Exported$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return ExportedRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<ExportedRefMut> {
        let pointer = __swift_bridge__$Vec_Exported$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return ExportedRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<ExportedRef> {
        UnsafePointer<ExportedRef>(OpaquePointer(__swift_bridge__$Vec_Exported$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Exported$len(vecPtr)
    }
}

extension Exported: @unchecked Sendable {}
public class Edits: EditsRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Edits$_free(ptr)
        }
    }
}
extension Edits {
    public convenience init() {
        self.init(ptr: __swift_bridge__$Edits$new())
    }
}
public class EditsRefMut: EditsRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class EditsRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension EditsRef {
    public func crop(_ bounds: Box3) {
        __swift_bridge__$Edits$crop(ptr, bounds.intoFfiRepr())
    }

    public func delete_clusters(_ clusters: UnsafeBufferPointer<UInt32>) {
        __swift_bridge__$Edits$delete_clusters(ptr, clusters.toFfiSlice())
    }

    public func keep_clusters(_ clusters: UnsafeBufferPointer<UInt32>) {
        __swift_bridge__$Edits$keep_clusters(ptr, clusters.toFfiSlice())
    }

    public func delete_faint(_ below: Double) {
        __swift_bridge__$Edits$delete_faint(ptr, below)
    }

    public func remove_floaters(_ sigmas: Double) {
        __swift_bridge__$Edits$remove_floaters(ptr, sigmas)
    }

    public func rename<GenericIntoRustString: IntoRustString>(_ cluster: UInt32, _ name: Optional<GenericIntoRustString>) {
        __swift_bridge__$Edits$rename(ptr, cluster, { if let rustString = optionalStringIntoRustString(name) { rustString.isOwned = false; return rustString.ptr } else { return nil } }())
    }

    public func recolor(_ cluster: UInt32, _ red: Float, _ green: Float, _ blue: Float) {
        __swift_bridge__$Edits$recolor(ptr, cluster, red, green, blue)
    }
}
extension Edits: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Edits$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Edits$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Edits) {
        __swift_bridge__$Vec_Edits$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Edits$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Edits(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<EditsRef> {
        let pointer = __swift_bridge__$Vec_Edits$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return EditsRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<EditsRefMut> {
        let pointer = __swift_bridge__$Vec_Edits$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return EditsRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<EditsRef> {
        UnsafePointer<EditsRef>(OpaquePointer(__swift_bridge__$Vec_Edits$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Edits$len(vecPtr)
    }
}

extension Edits: @unchecked Sendable {}
public class Device: DeviceRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Device$_free(ptr)
        }
    }
}
public class DeviceRefMut: DeviceRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class DeviceRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension DeviceRef {
    public func name() -> RustString {
        RustString(ptr: __swift_bridge__$Device$name(ptr))
    }
}
extension Device: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Device$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Device$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Device) {
        __swift_bridge__$Vec_Device$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Device$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Device(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<DeviceRef> {
        let pointer = __swift_bridge__$Vec_Device$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return DeviceRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<DeviceRefMut> {
        let pointer = __swift_bridge__$Vec_Device$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return DeviceRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<DeviceRef> {
        UnsafePointer<DeviceRef>(OpaquePointer(__swift_bridge__$Vec_Device$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Device$len(vecPtr)
    }
}

extension Device: @unchecked Sendable {}
public class Renderer: RendererRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Renderer$_free(ptr)
        }
    }
}
public class RendererRefMut: RendererRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class RendererRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension RendererRef {
    public func device_name() -> RustString {
        RustString(ptr: __swift_bridge__$Renderer$device_name(ptr))
    }

    public func attach(_ layer: UInt, _ width: UInt32, _ height: UInt32) throws -> () {
        try { let val = __swift_bridge__$Renderer$attach(ptr, layer, width, height); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }

    public func show(_ scene: SceneRef, _ options: RendererParameters, _ work: WorkRef) throws -> () {
        try { let val = __swift_bridge__$Renderer$show(ptr, scene.ptr, options.intoFfiRepr(), work.ptr); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }

    public func draw(_ frame: FrameParameters, _ world_to_camera: UnsafeBufferPointer<Double>, _ clusters: UnsafeBufferPointer<UInt32>) throws -> DrawFigures {
        try { let val = __swift_bridge__$Renderer$draw(ptr, frame.intoFfiRepr(), world_to_camera.toFfiSlice(), clusters.toFfiSlice()); switch val.tag { case __swift_bridge__$ResultDrawFiguresAndFailure$ResultOk: return val.payload.ok.intoSwiftRepr() case __swift_bridge__$ResultDrawFiguresAndFailure$ResultErr: throw Failure(ptr: val.payload.err) default: fatalError() } }()
    }

    public func render(_ frame: FrameParameters, _ world_to_camera: UnsafeBufferPointer<Double>, _ clusters: UnsafeBufferPointer<UInt32>) throws -> Image {
        try { let val = __swift_bridge__$Renderer$render(ptr, frame.intoFfiRepr(), world_to_camera.toFfiSlice(), clusters.toFfiSlice()); if val.is_ok { return Image(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }

    public func pick(_ frame: FrameParameters, _ world_to_camera: UnsafeBufferPointer<Double>, _ clusters: UnsafeBufferPointer<UInt32>, _ x: UInt32, _ y: UInt32) throws -> PickFigures {
        try { let val = __swift_bridge__$Renderer$pick(ptr, frame.intoFfiRepr(), world_to_camera.toFfiSlice(), clusters.toFfiSlice(), x, y); switch val.tag { case __swift_bridge__$ResultPickFiguresAndFailure$ResultOk: return val.payload.ok.intoSwiftRepr() case __swift_bridge__$ResultPickFiguresAndFailure$ResultErr: throw Failure(ptr: val.payload.err) default: fatalError() } }()
    }

    public func measure(_ lens: Lens, _ world_to_camera: UnsafeBufferPointer<Double>, _ times: UnsafeBufferPointer<Double>, _ half_precision: UnsafeBufferPointer<UInt8>, _ percentiles: UnsafeBufferPointer<Double>, _ work: WorkRef) throws -> Measurements {
        try { let val = __swift_bridge__$Renderer$measure(ptr, lens.intoFfiRepr(), world_to_camera.toFfiSlice(), times.toFfiSlice(), half_precision.toFfiSlice(), percentiles.toFfiSlice(), work.ptr); if val.is_ok { return Measurements(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }

    public func shed_memory() throws -> () {
        try { let val = __swift_bridge__$Renderer$shed_memory(ptr); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }

    public func suspend() throws -> () {
        try { let val = __swift_bridge__$Renderer$suspend(ptr); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }

    public func resume() throws -> () {
        try { let val = __swift_bridge__$Renderer$resume(ptr); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }
}
extension Renderer: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Renderer$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Renderer$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Renderer) {
        __swift_bridge__$Vec_Renderer$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Renderer$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Renderer(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<RendererRef> {
        let pointer = __swift_bridge__$Vec_Renderer$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return RendererRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<RendererRefMut> {
        let pointer = __swift_bridge__$Vec_Renderer$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return RendererRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<RendererRef> {
        UnsafePointer<RendererRef>(OpaquePointer(__swift_bridge__$Vec_Renderer$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Renderer$len(vecPtr)
    }
}

extension Renderer: @unchecked Sendable {}
public class Measurements: MeasurementsRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Measurements$_free(ptr)
        }
    }
}
public class MeasurementsRefMut: MeasurementsRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class MeasurementsRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension MeasurementsRef {
    public func measurement(_ index: UInt) -> MeasurementFigures {
        __swift_bridge__$Measurements$measurement(ptr, index).intoSwiftRepr()
    }
}
extension Measurements: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Measurements$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Measurements$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Measurements) {
        __swift_bridge__$Vec_Measurements$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Measurements$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Measurements(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<MeasurementsRef> {
        let pointer = __swift_bridge__$Vec_Measurements$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return MeasurementsRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<MeasurementsRefMut> {
        let pointer = __swift_bridge__$Vec_Measurements$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return MeasurementsRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<MeasurementsRef> {
        UnsafePointer<MeasurementsRef>(OpaquePointer(__swift_bridge__$Vec_Measurements$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Measurements$len(vecPtr)
    }
}

extension Measurements: @unchecked Sendable {}
public class SearchModel: SearchModelRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$SearchModel$_free(ptr)
        }
    }
}
public class SearchModelRefMut: SearchModelRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class SearchModelRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension SearchModelRef {
    public func name() -> RustString {
        RustString(ptr: __swift_bridge__$SearchModel$name(ptr))
    }

    public func threshold() -> Double {
        __swift_bridge__$SearchModel$threshold(ptr)
    }
}
extension SearchModel: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_SearchModel$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_SearchModel$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: SearchModel) {
        __swift_bridge__$Vec_SearchModel$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_SearchModel$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (SearchModel(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SearchModelRef> {
        let pointer = __swift_bridge__$Vec_SearchModel$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SearchModelRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SearchModelRefMut> {
        let pointer = __swift_bridge__$Vec_SearchModel$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SearchModelRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<SearchModelRef> {
        UnsafePointer<SearchModelRef>(OpaquePointer(__swift_bridge__$Vec_SearchModel$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_SearchModel$len(vecPtr)
    }
}

extension SearchModel: @unchecked Sendable {}
public class Searcher: SearcherRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Searcher$_free(ptr)
        }
    }
}
public class SearcherRefMut: SearcherRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class SearcherRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension SearcherRef {
    public func encode<GenericIntoRustString: IntoRustString>(_ renderer: RendererRef, _ cache: GenericIntoRustString, _ work: WorkRef) throws -> () {
        try { let val = __swift_bridge__$Searcher$encode(ptr, renderer.ptr, { let rustString = cache.intoRustString(); rustString.isOwned = false; return rustString.ptr }(), work.ptr); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }

    public func encoded_clusters() -> RustVec<UInt32> {
        RustVec(ptr: __swift_bridge__$Searcher$encoded_clusters(ptr))
    }

    public func take_picture(_ cluster: UInt32) throws -> Image {
        try { let val = __swift_bridge__$Searcher$take_picture(ptr, cluster); if val.is_ok { return Image(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }

    public func search<GenericIntoRustString: IntoRustString>(_ text: GenericIntoRustString) throws -> Hits {
        try { let val = __swift_bridge__$Searcher$search(ptr, { let rustString = text.intoRustString(); rustString.isOwned = false; return rustString.ptr }()); if val.is_ok { return Hits(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }
}
extension Searcher: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Searcher$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Searcher$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Searcher) {
        __swift_bridge__$Vec_Searcher$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Searcher$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Searcher(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SearcherRef> {
        let pointer = __swift_bridge__$Vec_Searcher$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SearcherRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SearcherRefMut> {
        let pointer = __swift_bridge__$Vec_Searcher$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SearcherRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<SearcherRef> {
        UnsafePointer<SearcherRef>(OpaquePointer(__swift_bridge__$Vec_Searcher$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Searcher$len(vecPtr)
    }
}

extension Searcher: @unchecked Sendable {}
public class Hits: HitsRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Hits$_free(ptr)
        }
    }
}
public class HitsRefMut: HitsRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class HitsRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension HitsRef {
    public func count() -> UInt {
        __swift_bridge__$Hits$count(ptr)
    }

    public func hit(_ index: UInt) -> HitFigures {
        __swift_bridge__$Hits$hit(ptr, index).intoSwiftRepr()
    }
}
extension Hits: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Hits$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Hits$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Hits) {
        __swift_bridge__$Vec_Hits$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Hits$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Hits(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<HitsRef> {
        let pointer = __swift_bridge__$Vec_Hits$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return HitsRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<HitsRefMut> {
        let pointer = __swift_bridge__$Vec_Hits$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return HitsRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<HitsRef> {
        UnsafePointer<HitsRef>(OpaquePointer(__swift_bridge__$Vec_Hits$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Hits$len(vecPtr)
    }
}

extension Hits: @unchecked Sendable {}
public class SelfCheck: SelfCheckRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$SelfCheck$_free(ptr)
        }
    }
}
public class SelfCheckRefMut: SelfCheckRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class SelfCheckRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension SelfCheckRef {
    public func device_name() -> RustString {
        RustString(ptr: __swift_bridge__$SelfCheck$device_name(ptr))
    }

    public func count() -> UInt {
        __swift_bridge__$SelfCheck$count(ptr)
    }

    public func check(_ index: UInt) -> CheckFigures {
        __swift_bridge__$SelfCheck$check(ptr, index).intoSwiftRepr()
    }

    public func check_name(_ index: UInt) -> RustString {
        RustString(ptr: __swift_bridge__$SelfCheck$check_name(ptr, index))
    }

    public func check_note(_ index: UInt) -> Optional<RustString> {
        { let val = __swift_bridge__$SelfCheck$check_note(ptr, index); if val != nil { return RustString(ptr: val!) } else { return nil } }()
    }
}
extension SelfCheck: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_SelfCheck$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_SelfCheck$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: SelfCheck) {
        __swift_bridge__$Vec_SelfCheck$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_SelfCheck$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (SelfCheck(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SelfCheckRef> {
        let pointer = __swift_bridge__$Vec_SelfCheck$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SelfCheckRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<SelfCheckRefMut> {
        let pointer = __swift_bridge__$Vec_SelfCheck$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return SelfCheckRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<SelfCheckRef> {
        UnsafePointer<SelfCheckRef>(OpaquePointer(__swift_bridge__$Vec_SelfCheck$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_SelfCheck$len(vecPtr)
    }
}

extension SelfCheck: @unchecked Sendable {}
public class Dataset: DatasetRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Dataset$_free(ptr)
        }
    }
}
public class DatasetRefMut: DatasetRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class DatasetRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension DatasetRef {
    public func figures() -> DatasetFigures {
        __swift_bridge__$Dataset$figures(ptr).intoSwiftRepr()
    }

    public func format_name() -> RustString {
        RustString(ptr: __swift_bridge__$Dataset$format_name(ptr))
    }

    public func warnings() -> RustVec<RustString> {
        RustVec(ptr: __swift_bridge__$Dataset$warnings(ptr))
    }

    public func view_lens(_ index: UInt) -> Lens {
        __swift_bridge__$Dataset$view_lens(ptr, index).intoSwiftRepr()
    }

    public func view_world_to_camera(_ index: UInt) -> RustVec<Double> {
        RustVec(ptr: __swift_bridge__$Dataset$view_world_to_camera(ptr, index))
    }

    public func view_time(_ index: UInt) -> Float {
        __swift_bridge__$Dataset$view_time(ptr, index)
    }
}
extension Dataset: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Dataset$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Dataset$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Dataset) {
        __swift_bridge__$Vec_Dataset$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Dataset$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Dataset(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<DatasetRef> {
        let pointer = __swift_bridge__$Vec_Dataset$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return DatasetRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<DatasetRefMut> {
        let pointer = __swift_bridge__$Vec_Dataset$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return DatasetRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<DatasetRef> {
        UnsafePointer<DatasetRef>(OpaquePointer(__swift_bridge__$Vec_Dataset$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Dataset$len(vecPtr)
    }
}

extension Dataset: @unchecked Sendable {}
public class Trainer: TrainerRefMut {
    var isOwned: Bool = true

    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }

    deinit {
        if isOwned {
            __swift_bridge__$Trainer$_free(ptr)
        }
    }
}
public class TrainerRefMut: TrainerRef {
    public override init(ptr: UnsafeMutableRawPointer) {
        super.init(ptr: ptr)
    }
}
public class TrainerRef {
    var ptr: UnsafeMutableRawPointer

    public init(ptr: UnsafeMutableRawPointer) {
        self.ptr = ptr
    }
}
extension TrainerRef {
    public func device_name() -> RustString {
        RustString(ptr: __swift_bridge__$Trainer$device_name(ptr))
    }

    public func current_step() -> UInt32 {
        __swift_bridge__$Trainer$current_step(ptr)
    }

    public func is_finished() -> Bool {
        __swift_bridge__$Trainer$is_finished(ptr)
    }

    public func advance(_ work: WorkRef) throws -> () {
        try { let val = __swift_bridge__$Trainer$advance(ptr, work.ptr); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }

    public func next_event() -> TrainEventFigures {
        __swift_bridge__$Trainer$next_event(ptr).intoSwiftRepr()
    }

    public func rollback_reason() -> RustString {
        RustString(ptr: __swift_bridge__$Trainer$rollback_reason(ptr))
    }

    public func checkpoint() throws -> () {
        try { let val = __swift_bridge__$Trainer$checkpoint(ptr); if val != nil { throw Failure(ptr: val!) } else { return } }()
    }

    public func finish(_ work: WorkRef) throws -> TestFigures {
        try { let val = __swift_bridge__$Trainer$finish(ptr, work.ptr); switch val.tag { case __swift_bridge__$ResultTestFiguresAndFailure$ResultOk: return val.payload.ok.intoSwiftRepr() case __swift_bridge__$ResultTestFiguresAndFailure$ResultErr: throw Failure(ptr: val.payload.err) default: fatalError() } }()
    }

    public func report() -> TrainFigures {
        __swift_bridge__$Trainer$report(ptr).intoSwiftRepr()
    }

    public func preview(_ lens: Lens, _ world_to_camera: UnsafeBufferPointer<Double>, _ time: Float) throws -> Image {
        try { let val = __swift_bridge__$Trainer$preview(ptr, lens.intoFfiRepr(), world_to_camera.toFfiSlice(), time); if val.is_ok { return Image(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }

    public func trained_scene() throws -> Scene {
        try { let val = __swift_bridge__$Trainer$trained_scene(ptr); if val.is_ok { return Scene(ptr: val.ok_or_err!) } else { throw Failure(ptr: val.ok_or_err!) } }()
    }
}
extension Trainer: Vectorizable {
    public static func vecOfSelfNew() -> UnsafeMutableRawPointer {
        __swift_bridge__$Vec_Trainer$new()
    }

    public static func vecOfSelfFree(vecPtr: UnsafeMutableRawPointer) {
        __swift_bridge__$Vec_Trainer$drop(vecPtr)
    }

    public static func vecOfSelfPush(vecPtr: UnsafeMutableRawPointer, value: Trainer) {
        __swift_bridge__$Vec_Trainer$push(vecPtr, {value.isOwned = false; return value.ptr;}())
    }

    public static func vecOfSelfPop(vecPtr: UnsafeMutableRawPointer) -> Optional<Self> {
        let pointer = __swift_bridge__$Vec_Trainer$pop(vecPtr)
        if pointer == nil {
            return nil
        } else {
            return (Trainer(ptr: pointer!) as! Self)
        }
    }

    public static func vecOfSelfGet(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<TrainerRef> {
        let pointer = __swift_bridge__$Vec_Trainer$get(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return TrainerRef(ptr: pointer!)
        }
    }

    public static func vecOfSelfGetMut(vecPtr: UnsafeMutableRawPointer, index: UInt) -> Optional<TrainerRefMut> {
        let pointer = __swift_bridge__$Vec_Trainer$get_mut(vecPtr, index)
        if pointer == nil {
            return nil
        } else {
            return TrainerRefMut(ptr: pointer!)
        }
    }

    public static func vecOfSelfAsPtr(vecPtr: UnsafeMutableRawPointer) -> UnsafePointer<TrainerRef> {
        UnsafePointer<TrainerRef>(OpaquePointer(__swift_bridge__$Vec_Trainer$as_ptr(vecPtr)))
    }

    public static func vecOfSelfLen(vecPtr: UnsafeMutableRawPointer) -> UInt {
        __swift_bridge__$Vec_Trainer$len(vecPtr)
    }
}

extension Trainer: @unchecked Sendable {}
